#pragma once

#include <chrono>
#include <cstdio>
#include <string>

namespace conav {

/// Shows the progress of a long command: one line that is rewritten on a terminal, elsewhere one
/// line per call.
class ProgressLine {
 public:
  explicit ProgressLine(std::FILE* out = stderr);
  /// Ends the line, if one is open.
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  void Show(const std::string& text);
  /// The same for frequent callers: shows nothing within a second of the start or of the last text.
  void ShowNowAndThen(const std::string& text);

 private:
  using Clock = std::chrono::steady_clock;

  std::FILE* out_;
  bool rewrites_;
  bool open_ = false;
  Clock::time_point next_ = Clock::now() + std::chrono::seconds(1);
};

/// "0:07", "12:34", "1:02:03".
std::string DurationText(double seconds);

}  // namespace conav
