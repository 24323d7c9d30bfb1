#include "operator/statistics/csv_row.h"

#include <algorithm>
#include <utility>

namespace conav::statistics {
namespace {

std::string_view Trim(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(" \t");
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(" \t") - begin + 1);
}

void SkipSpaces(std::string_view& rest) {
  rest.remove_prefix(std::min(rest.find_first_not_of(" \t"), rest.size()));
}

/// What stands between quotes at the start of `rest`, which then begins after them.
Result<std::string> TakeQuoted(std::string_view& rest) {
  std::string field;
  for (std::size_t i = 1; i < rest.size(); ++i) {
    if (rest[i] == '"') {
      const bool doubled = i + 1 < rest.size() && rest[i + 1] == '"';
      if (!doubled) {
        rest.remove_prefix(i + 1);
        return std::string(Trim(field));
      }
      ++i;
    }
    field += rest[i];
  }
  return Fail(ErrorCode::kMalformed, "a quote does not end");
}

std::string TakePlain(std::string_view& rest) {
  const std::size_t end = std::min(rest.find(','), rest.size());
  std::string field(Trim(rest.substr(0, end)));
  rest.remove_prefix(end);
  return field;
}

}  // namespace

Result<std::vector<std::string>> SplitCsvRow(std::string_view line) {
  std::vector<std::string> fields;
  for (std::string_view rest = line;; rest.remove_prefix(1)) {
    SkipSpaces(rest);
    if (!rest.empty() && rest.front() == '"') {
      auto field = TakeQuoted(rest);
      if (!field) return tl::unexpected(field.error());
      fields.push_back(std::move(*field));
      SkipSpaces(rest);
      if (!rest.empty() && rest.front() != ',') {
        return Fail(ErrorCode::kMalformed, "after a quoted field a comma must follow");
      }
    } else {
      fields.push_back(TakePlain(rest));
    }
    if (rest.empty()) return fields;
  }
}

}  // namespace conav::statistics
