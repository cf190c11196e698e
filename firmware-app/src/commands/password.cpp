#include <termios.h>
#include <unistd.h>

#include <iostream>
#include <string>

#include "commands/commands.hpp"
#include "http/password_file.hpp"

namespace octurn {
namespace {

/// Switches the terminal's echo off during its lifetime.
class HiddenTyping {
 public:
  HiddenTyping() {
    if (::tcgetattr(STDIN_FILENO, &before_) == 0) {
      termios hidden = before_;
      hidden.c_lflag &= ~static_cast<tcflag_t>(ECHO);
      ::tcsetattr(STDIN_FILENO, TCSAFLUSH, &hidden);
      on_terminal_ = true;
      std::cerr << "New password of the page: " << std::flush;
    }
  }
  ~HiddenTyping() {
    if (on_terminal_) {
      ::tcsetattr(STDIN_FILENO, TCSAFLUSH, &before_);
      std::cerr << '\n';
    }
  }
  HiddenTyping(const HiddenTyping&) = delete;
  HiddenTyping& operator=(const HiddenTyping&) = delete;

 private:
  termios before_ = {};
  bool on_terminal_ = false;
};

}  // namespace

void set_password(const std::filesystem::path& file) {
  std::string password;
  {
    const HiddenTyping hidden;
    std::getline(std::cin, password);
  }
  write_password_file(file, password);
  std::cerr << "The page's user is " << page_user << ".\n";
}

}  // namespace octurn
