#include "common/cli/progress_line.h"

#include <fmt/core.h>
#include <unistd.h>

namespace conav {

ProgressLine::ProgressLine(std::FILE* out) : out_(out), rewrites_(isatty(fileno(out)) == 1) {}

ProgressLine::~ProgressLine() {
  if (open_) std::fputc('\n', out_);
}

void ProgressLine::Show(const std::string& text) {
  std::fputs(rewrites_ ? fmt::format("\r{}\x1b[K", text).c_str() : (text + "\n").c_str(), out_);
  open_ = rewrites_;
  std::fflush(out_);
}

void ProgressLine::ShowNowAndThen(const std::string& text) {
  const auto now = Clock::now();
  if (now < next_) return;
  next_ = now + std::chrono::seconds(1);
  Show(text);
}

std::string DurationText(double seconds) {
  const auto whole = static_cast<long>(seconds + 0.5);
  const long hours = whole / 3600;
  const long minutes = whole / 60 % 60;
  if (hours > 0) return fmt::format("{}:{:02}:{:02}", hours, minutes, whole % 60);
  return fmt::format("{}:{:02}", minutes, whole % 60);
}

}  // namespace conav
