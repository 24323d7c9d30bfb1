#pragma once

#include <cstdio>
#include <string>

namespace conav::nhpm {

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

 private:
  std::FILE* out_;
  bool rewrites_;
  bool open_ = false;
};

/// "0:07", "12:34", "1:02:03".
std::string DurationText(double seconds);

}  // namespace conav::nhpm
