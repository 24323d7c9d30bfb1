#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace conav::test {

/// Reads a document once, from its begin; see XmlError().
class XmlChecker {
 public:
  explicit XmlChecker(std::string_view text) : rest_(text) {}

  std::string Error() {
    while (!rest_.empty() && error_.empty()) {
      CheckText(TakeUntil(std::min(rest_.find('<'), rest_.size())));
      if (!rest_.empty()) TakeTag();
    }
    if (error_.empty() && !open_.empty()) Fail("<{}> is not closed", open_.back());
    if (error_.empty() && !has_tags_) Fail("it holds no tag");
    return error_;
  }

 private:
  template <class... Values>
  void Fail(const char* text, const Values&... values) {
    if (error_.empty()) error_ = fmt::format(fmt::runtime(text), values...);
  }

  std::string_view TakeUntil(std::size_t end) {
    const std::string_view taken = rest_.substr(0, end);
    rest_.remove_prefix(taken.size());
    return taken;
  }
  bool Take(std::string_view text) {
    if (!rest_.starts_with(text)) return false;
    rest_.remove_prefix(text.size());
    return true;
  }
  std::string TakeName() {
    constexpr std::string_view kNameSigns =
        "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_:.";
    return std::string(TakeUntil(std::min(rest_.find_first_not_of(kNameSigns), rest_.size())));
  }
  void SkipBlanks() { TakeUntil(std::min(rest_.find_first_not_of(" \t\r\n"), rest_.size())); }

  /// Between tags, or the value of an attribute.
  void CheckText(std::string_view text) {
    const auto is_forbidden = [](char c) {
      return static_cast<unsigned char>(c) < 0x20 && c != '\t' && c != '\n' && c != '\r';
    };
    if (std::ranges::any_of(text, is_forbidden)) Fail("a control character in \"{}\"", text);
    if (text.find('<') != std::string_view::npos) Fail("< in \"{}\"", text);
    for (auto at = text.find('&'); at != std::string_view::npos; at = text.find('&', at + 1)) {
      const std::string_view name = text.substr(at, text.find(';', at) - at);
      if (std::ranges::find(kEntities, name) == std::end(kEntities)) Fail("& in \"{}\"", text);
    }
  }

  void TakeTag() {
    has_tags_ = true;
    if (Take("<!") || Take("<?")) {
      if (TakeUntil(rest_.find('>')).empty() || !Take(">")) Fail("a <! that does not end");
      return;
    }
    if (Take("</")) return TakeEndTag(TakeName());
    Take("<");
    const std::string name = TakeName();
    if (name.empty()) return Fail("a < that begins no tag");
    TakeAttributes(name);
    if (Take("/>") || !error_.empty()) return;
    if (!Take(">")) return Fail("<{}> does not end", name);
    open_.push_back(name);
  }

  void TakeEndTag(const std::string& name) {
    SkipBlanks();
    if (!Take(">")) return Fail("</{}> does not end", name);
    if (open_.empty() || open_.back() != name) {
      return Fail("</{}> closes {}", name, open_.empty() ? "nothing" : open_.back());
    }
    open_.pop_back();
  }

  void TakeAttributes(const std::string& tag) {
    std::set<std::string> names;
    SkipBlanks();
    while (error_.empty() && !rest_.empty() && !rest_.starts_with('/') && !rest_.starts_with('>')) {
      const std::string name = TakeName();
      if (name.empty() || !Take("=\"")) return Fail("<{}>: \"{}\" has no value", tag, name);
      if (!names.insert(name).second) return Fail("<{}>: {} is there twice", tag, name);
      CheckText(TakeUntil(std::min(rest_.find('"'), rest_.size())));
      if (!Take("\"")) return Fail("<{}>: the value of {} does not end", tag, name);
      SkipBlanks();
    }
  }

  static constexpr std::string_view kEntities[] = {"&lt", "&gt", "&amp", "&quot", "&apos"};

  std::string_view rest_;
  std::vector<std::string> open_;
  std::string error_;
  bool has_tags_ = false;
};

/// What is wrong with `text` as XML; empty when it is well-formed. Strict about what we write
/// ourselves: attributes in double quotes, the five entities by name, no CDATA. A page of HTML that
/// keeps to this passes, too.
inline std::string XmlError(std::string_view text) { return XmlChecker(text).Error(); }

}  // namespace conav::test
