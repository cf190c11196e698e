#include "camera/released_lines.hpp"

#include <fstream>
#include <string>

#include "octurn/error.hpp"

namespace octurn {

void expect_released_lines_to_fall(const std::filesystem::path& sys) {
  // The chips of the Pi 4 and older, and of the Pi 5.
  for (const char* const driver : {"pinctrl_bcm2835", "pinctrl_rp1"}) {
    std::ifstream parameter(sys / "module" / driver / "parameters" / "persist_gpio_outputs");
    char value = 'N';
    if (parameter >> value && value == 'Y') {
      throw Error(ErrorCode::sensor_failed,
                  std::string("lasers: this kernel keeps a laser on if Octurn crashes, as ") +
                      driver + ".persist_gpio_outputs is Y",
                  "Add the line dtparam=strict_gpiod to /boot/firmware/config.txt, and start the "
                  "Raspberry Pi again.");
    }
  }
}

}  // namespace octurn
