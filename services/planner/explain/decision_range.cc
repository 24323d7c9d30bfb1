#include "planner/explain/decision_range.h"

#include <fmt/format.h>

#include <charconv>

namespace conav::planner {
namespace {

bool ReadNumber(std::string_view text, std::uint64_t& number) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc() && end == text.data() + text.size() && number >= 1;
}

}  // namespace

Result<DecisionRange> ParseDecisionRange(std::string_view text) {
  const std::size_t dots = text.find("..");
  DecisionRange range;
  const bool read = ReadNumber(text.substr(0, dots), range.first) &&
                    ReadNumber(dots == text.npos ? text : text.substr(dots + 2), range.last);
  if (read && range.first <= range.last) return range;
  return Fail(ErrorCode::kInvalidArgument,
              fmt::format("'{}' is neither a decision, 12, nor a range of them, 12..20", text));
}

}  // namespace conav::planner
