#include "study/statistics/table_reader.h"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <utility>

#include "common/runtime/text.h"
#include "study/statistics/moments.h"

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

/// Takes the quoted text at the start of `rest`.
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
  return Fail(ErrorCode::kMalformed, "a quote is not closed");
}

std::string TakePlain(std::string_view& rest) {
  const std::size_t end = std::min(rest.find(','), rest.size());
  std::string field(Trim(rest.substr(0, end)));
  rest.remove_prefix(end);
  return field;
}

using Fields = std::vector<std::string>;

constexpr const char* kHeader = "subject,<condition>,<condition>,...";

/// Reads line by line; stops at the first failure.
class TableReader {
 public:
  explicit TableReader(const std::string& name) : name_(name) {}

  Result<void> ReadLine(std::string_view line) {
    ++line_;
    if (auto checked = CheckText(line); !checked) return checked;
    auto fields = SplitCsvRow(line);
    if (!fields) return Refuse(fields.error().text);
    const bool blank = std::all_of(fields->begin(), fields->end(),
                                   [](const std::string& field) { return field.empty(); });
    if (blank) return {};
    return file_.table.conditions.empty() ? ReadHeader(*fields) : ReadRow(*fields);
  }

  Result<TableFile> Finish() {
    if (file_.table.conditions.empty()) {
      return Fail(ErrorCode::kMalformed,
                  fmt::format("{}: is empty; the first line must be {}", name_, kHeader));
    }
    const std::size_t count = file_.table.subject_count();
    if (count >= 2) return std::move(file_);
    std::string text = fmt::format("{}: {} with a value in every condition; at least 2 are needed",
                                   name_, count == 1 ? "1 subject" : "no subject");
    for (const LeftOut& left : file_.left_out) {
      text += fmt::format("; {} (line {}) has none in {}", left.subject, left.line,
                          Join(left.missing, ", "));
    }
    return Fail(ErrorCode::kMalformed, text);
  }

 private:
  tl::unexpected<Error> Refuse(const std::string& reason) const {
    return Fail(ErrorCode::kMalformed, fmt::format("{}:{}: {}", name_, line_, reason));
  }

  Result<void> CheckText(std::string_view line) const {
    if (!IsUtf8(line)) return Refuse("is not UTF-8");
    const auto control = std::find_if(line.begin(), line.end(), [](char c) {
      return (c >= 0 && c < ' ' && c != '\t') || c == '\x7F';
    });
    if (control == line.end()) return {};
    return Refuse(fmt::format("has a control character, byte {:#04x} at position {}",
                              static_cast<unsigned>(*control), control - line.begin() + 1));
  }

  Result<void> ReadHeader(const Fields& fields) {
    if (fields[0] != "subject") {
      return Refuse(fmt::format("begins with '{}'; the first line must be {}{}", fields[0], kHeader,
                                fields.size() == 1 ? " with commas between the columns" : ""));
    }
    if (fields.size() < 3 || fields.size() > kMostConditions + 1) {
      return Refuse(fmt::format("{} after subject; 2 to {} are possible",
                                fields.size() == 2
                                    ? std::string("1 condition")
                                    : fmt::format("{} conditions", fields.size() - 1),
                                kMostConditions));
    }
    std::map<std::string, std::size_t> columns;
    for (std::size_t c = 1; c < fields.size(); ++c) {
      if (fields[c].empty()) return Refuse(fmt::format("column {} has no name", c + 1));
      const auto [known, is_new] = columns.emplace(fields[c], c + 1);
      if (is_new) continue;
      return Refuse(fmt::format("condition '{}' appears twice, in columns {} and {}", fields[c],
                                known->second, c + 1));
    }
    file_.table.conditions.assign(fields.begin() + 1, fields.end());
    return {};
  }

  Result<void> ReadRow(const Fields& fields) {
    const std::size_t count = file_.table.condition_count();
    if (fields.size() < count + 1) {
      return Refuse(fmt::format("column '{}' is missing: {} columns instead of {}",
                                file_.table.conditions[fields.size() - 1], fields.size(),
                                count + 1));
    }
    if (fields.size() > count + 1) {
      return Refuse(fmt::format("{} columns instead of {} (decimals have a point, not a comma)",
                                fields.size(), count + 1));
    }
    if (auto named = AddName(fields[0]); !named) return named;
    return ReadValues(fields);
  }

  Result<void> AddName(const std::string& subject) {
    if (subject.empty()) return Refuse("column 'subject' is empty");
    const auto [known, is_new] = lines_.emplace(subject, line_);
    if (is_new) return {};
    return Refuse(
        fmt::format("subject '{}' appears twice, first in line {}", subject, known->second));
  }

  Result<void> ReadValues(const Fields& fields) {
    std::vector<double> values;
    LeftOut left{fields[0], line_, {}};
    for (std::size_t c = 1; c < fields.size(); ++c) {
      const std::string& condition = file_.table.conditions[c - 1];
      if (fields[c].empty() || fields[c] == "NA") {
        left.missing.push_back(condition);
        continue;
      }
      const auto value = ReadValue(fields[c], condition);
      if (!value) return tl::unexpected(value.error());
      values.push_back(*value);
    }
    if (!left.missing.empty()) {
      file_.left_out.push_back(std::move(left));
      return {};
    }
    file_.table.subjects.push_back(fields[0]);
    file_.table.values.insert(file_.table.values.end(), values.begin(), values.end());
    return {};
  }

  Result<double> ReadValue(const std::string& text, const std::string& condition) const {
    const char* end = text.data() + text.size();
    const char* begin = text.data() + (text.size() > 1 && text[0] == '+' && text[1] != '-' ? 1 : 0);
    double value = 0.0;
    const auto [stop, error] = std::from_chars(begin, end, value);
    if (error == std::errc::invalid_argument || stop != end || std::isnan(value)) {
      return Refuse(fmt::format("column '{}': '{}' is not a number", condition, text));
    }
    const double size = std::abs(value);
    if (error == std::errc::result_out_of_range || size > kLargestValue ||
        (size > 0.0 && size < 1.0 / kLargestValue)) {
      return Refuse(fmt::format("column '{}': {} is out of range, {} to {} or 0", condition, text,
                                1.0 / kLargestValue, kLargestValue));
    }
    return value;
  }

  const std::string& name_;
  std::size_t line_ = 0;
  std::map<std::string, std::size_t> lines_;  // line of each subject
  TableFile file_;
};

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

std::vector<double> ConditionValues(const ConditionTable& table, std::size_t condition) {
  std::vector<double> values;
  values.reserve(table.subject_count());
  for (std::size_t i = 0; i < table.subject_count(); ++i) values.push_back(table.At(i, condition));
  return values;
}

double Magnitude(const ConditionTable& table) { return Magnitude(std::span(table.values)); }

Result<TableFile> ParseTable(std::string_view text, const std::string& name) {
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);  // a byte order mark
  TableReader reader(name);
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    if (line.ends_with('\r')) line.remove_suffix(1);
    if (auto read = reader.ReadLine(line); !read) return tl::unexpected(read.error());
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return reader.Finish();
}

}  // namespace conav::statistics
