#pragma once

#include <chrono>
#include <cstdio>
#include <string>

namespace conav {

/// How a long command says how far it is: on a terminal one line that is rewritten, elsewhere a
/// line for each call.
class ProgressLine {
 public:
  explicit ProgressLine(std::FILE* out = stderr);
  /// Ends the line, if one is open.
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  void Show(const std::string& text);
  /// For those who have more to show than anybody reads: nothing within a second after the begin or
  /// after what was shown so before.
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
