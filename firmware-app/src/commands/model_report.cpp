#include "commands/model_report.hpp"

#include <iostream>

#include "standard_output.hpp"

namespace octurn {

void print_verdict(const Quality& quality) {
  if (quality.verdict == Verdict::good) {
    return;
  }
  std::string text = quality.verdict == Verdict::bad ? "The model is bad: " : "Look at the model: ";
  for (const QualityReason& reason : quality.reasons) {
    text += (&reason == quality.reasons.data() ? "" : "; ") + reason.detail;
  }
  std::cerr << text + ".\n";
}

void print_agreement(const ViewAgreement& agreement) {
  if (!agreement.is_credible()) {
    std::cerr << agreement.agreeing << " readings agree with another depth image, and "
              << agreement.contradicted
              << " contradict one: look at the depth unit, the intrinsics and the poses.\n";
  }
}

void print_report(const std::filesystem::path& model, const std::string& json) {
  const std::string line = json + "\n";
  if (model == "-") {
    std::cerr << line;
  } else {
    write_standard_output(line);
  }
}

}  // namespace octurn
