#include "study/report_page.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "common/plot/svg.h"
#include "common/runtime/text.h"

namespace conav::study {
namespace {

/// Characters, not bytes, of UTF-8.
std::size_t Width(const std::string& text) {
  return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), [](char c) {
    return (static_cast<unsigned>(c) & 0xC0U) != 0x80U;
  }));
}

std::vector<std::size_t> Widths(const ReportSection& section) {
  std::vector<std::size_t> widths;
  for (const std::string& title : section.header) widths.push_back(Width(title));
  for (const auto& row : section.rows) {
    for (std::size_t c = 0; c < row.size(); ++c) widths[c] = std::max(widths[c], Width(row[c]));
  }
  return widths;
}

/// Names to the left, figures to the right.
std::string Line(const std::vector<std::string>& cells, const std::vector<std::size_t>& widths) {
  std::string line = "  " + cells[0] + std::string(widths[0] - Width(cells[0]), ' ');
  for (std::size_t c = 1; c < cells.size(); ++c) {
    line += std::string(2 + widths[c] - Width(cells[c]), ' ') + cells[c];
  }
  return line + "\n";
}

std::string Link(const std::string& file) {
  return fmt::format("<a href=\"{0}\">{0}</a>", EscapeXml(file));
}

bool Has(const std::vector<std::string>& files, const std::string& cell) {
  return std::ranges::find(files, cell) != files.end();
}

/// Cells that name one of `files` are links to it.
std::string Row(const std::vector<std::string>& cells, const char* first_scope, const char* tag,
                const std::vector<std::string>& files) {
  const auto text = [&](const std::string& cell) {
    return Has(files, cell) ? Link(cell) : EscapeXml(cell);
  };
  std::string html = fmt::format("<tr><th scope=\"{}\">{}</th>", first_scope, text(cells[0]));
  for (std::size_t c = 1; c < cells.size(); ++c) {
    html += fmt::format("<{0}>{1}</{0}>", tag, text(cells[c]));
  }
  return html + "</tr>\n";
}

/// The files that no cell names; each through `show`.
template <class Show>
std::string FilesText(const ReportSection& section, const Show& show) {
  std::string text;
  for (const std::string& file : section.files) {
    const bool is_cell = std::ranges::any_of(
        section.rows, [&](const std::vector<std::string>& row) { return Has(row, file); });
    if (!is_cell) text += (text.empty() ? "Source: " : ", ") + show(file);
  }
  return text;
}

/// Colours by prefers-color-scheme; self-contained.
constexpr const char* kStyle = R"css(
:root { color-scheme: light dark; --paper: #ffffff; --ink: #1c1c1c; --muted: #5a5a5a;
  --rule: #d8d8d8; --subject: #8a8a8a; --mean: #0072b2; --within: #d55e00; }
@media (prefers-color-scheme: dark) {
  :root { --paper: #16181c; --ink: #ececec; --muted: #a9a9a9; --rule: #3a3d44;
    --subject: #7d828c; --mean: #56b4e9; --within: #ff8a3d; } }
body { margin: 2rem auto; max-width: 76rem; padding: 0 1rem; background: var(--paper);
  color: var(--ink); font: 16px/1.5 system-ui, sans-serif; }
h1, h2 { line-height: 1.2; } h2 { font-size: 1.2rem; margin-top: 2rem; }
.wide { overflow-x: auto; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; }
th, td { padding: 0.3rem 0.7rem; border-bottom: 1px solid var(--rule); text-align: right;
  white-space: nowrap; }
th:first-child { text-align: left; }
figure { margin: 0; } svg { display: block; }
.muted, figcaption { color: var(--muted); font-size: 0.9rem; }
.rule { stroke: var(--rule); } .tick, .label { fill: var(--muted); font-size: 12px; }
.subject { stroke: var(--subject); stroke-opacity: 0.6; }
.interval { stroke: var(--mean); stroke-width: 2; } .mean { fill: var(--mean); }
.within { stroke: var(--within); stroke-width: 6; stroke-opacity: 0.8; }
)css";

constexpr std::size_t kMostText = 80;

std::string Processor() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);) {
    const std::size_t colon = line.find(": ");
    if (line.starts_with("model name") && colon != std::string::npos) return line.substr(colon + 2);
  }
  return "unknown processor";
}

}  // namespace

std::string SectionsText(std::span<const ReportSection> sections) {
  std::string text;
  for (const ReportSection& section : sections) {
    const std::vector<std::size_t> widths = Widths(section);
    text += "\n" + section.title + "\n";
    if (!section.header.empty()) text += Line(section.header, widths);
    for (const auto& row : section.rows) text += Line(row, widths);
    for (const std::string& remark : section.remarks) text += "  " + remark + "\n";
    const std::string files = FilesText(section, [](const std::string& file) { return file; });
    if (!files.empty()) text += "  " + files + "\n";
  }
  return text;
}

std::string SectionsHtml(std::span<const ReportSection> sections) {
  std::string html;
  for (const ReportSection& section : sections) {
    html += "<h2>" + EscapeXml(section.title) + "</h2>\n";
    if (!section.header.empty()) {
      html += "<div class=\"wide\" tabindex=\"0\">\n<table>\n<thead>" +
              Row(section.header, "col", "th", {}) + "</thead>\n<tbody>\n";
      for (const auto& row : section.rows) html += Row(row, "row", "td", section.files);
      html += "</tbody>\n</table>\n</div>\n";
    }
    for (const std::string& remark : section.remarks) html += "<p>" + EscapeXml(remark) + "</p>\n";
    const std::string files = FilesText(section, Link);
    if (!files.empty()) html += "<p class=\"muted\">" + files + "</p>\n";
  }
  return html;
}

std::string Page(const std::string& title, const std::string& body) {
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n"
      "<title>{0}</title>\n<style>{1}</style>\n</head>\n<body>\n<h1>{0}</h1>\n{2}"
      "</body>\n</html>\n",
      EscapeXml(title), kStyle, body);
}

nlohmann::ordered_json NumberJson(const std::optional<double>& value) {
  return value && std::isfinite(*value) ? nlohmann::ordered_json(*value) : nlohmann::ordered_json();
}

std::string CsvCell(const std::optional<double>& value) {
  return value ? fmt::format(",{}", *value) : ",";
}

std::string CsvText(const std::string& text) {
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string quoted;
  for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
  return '"' + quoted + '"';
}

std::string Quoted(const std::string& word) {
  constexpr std::string_view kPlain =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_=,./:+@%";
  if (!word.empty() && word.find_first_not_of(kPlain) == std::string::npos) return word;
  std::string inner;
  for (const char c : word) {
    if (c == '\'') inner += "'\\'";
    inner += c;
  }
  return fmt::format("'{}'", inner);
}

Provenance DescribeRun(const std::string& program, int argc, const char* const* argv) {
  Provenance provenance{.command = program};
  for (int i = 1; i < argc; ++i) provenance.command += fmt::format(" {}", Quoted(argv[i]));
  const char* commit = std::getenv("CONAV_COMMIT");
  provenance.commit = commit != nullptr ? commit : "unknown";
  provenance.date = UtcTime(std::time(nullptr), "%Y-%m-%d %H:%M UTC");
  provenance.machine =
      fmt::format("{}, {} cores", Processor(), std::thread::hardware_concurrency());
  return provenance;
}

ReportSection ProvenanceSection(const Provenance& provenance,
                                const nlohmann::ordered_json& design) {
  ReportSection section{.title = "Provenance", .header = {"", ""}};
  section.rows = {{"command", provenance.command},
                  {"commit", provenance.commit},
                  {"report written", provenance.date},
                  {"on", provenance.machine}};
  for (const auto& [key, value] : design.items()) {
    const std::string text = value.is_string() ? value.get<std::string>() : value.dump();
    if (!text.empty() && text.size() <= kMostText) section.rows.push_back({key, text});
  }
  return section;
}

}  // namespace conav::study
