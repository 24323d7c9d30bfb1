#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

/// What all reports are made of: tables for a terminal and a page, numbers of JSON and CSV.
namespace conav::study {

/// Bytes of one picture as the paper counts them (section 6.2): 180 KB; its table 3 shows that its
/// kilobytes and megabytes are powers of two.
inline constexpr double kPaperImageKib = 180.0;

/// A table for any output: the first column holds names, the others figures.
struct ReportSection {
  std::string title;
  std::vector<std::string> header;  // empty: no table, remarks alone
  std::vector<std::vector<std::string>> rows;
  std::vector<std::string> remarks;  // lines below
  /// The files that the figures come from, relative to the page, which links to them; a cell that names
  /// one of them is its link.
  std::vector<std::string> files;
};

/// For a terminal, with an empty line before each.
std::string SectionsText(std::span<const ReportSection> sections);

/// Title and table of each, for a page.
std::string SectionsHtml(std::span<const ReportSection> sections);

/// A self-contained page with the style sheet of tables and plots; `body` comes after its heading.
std::string Page(const std::string& title, const std::string& body);

/// Null for missing and infinite values.
nlohmann::ordered_json NumberJson(const std::optional<double>& value);

/// A value per cell, each after a comma; nothing after it for a missing one.
std::string CsvCell(const std::optional<double>& value);

/// `text` as a cell: in quotes where it needs them (RFC 4180).
std::string CsvText(const std::string& text);

/// `word` as a word of a shell's command line.
std::string Quoted(const std::string& word);

/// How a report came about. Only the page has it: tables and JSON of equal studies are equal.
struct Provenance {
  std::string command;  // as typed, after ./conav
  std::string commit;   // of the build by ./conav; "unknown" for a program run by hand
  std::string date;     // of the report, UTC
  std::string machine;  // processor and number of cores
};

/// Describes this process. `program` as a user calls it, `argv` as in main().
Provenance DescribeRun(const std::string& program, int argc, const char* const* argv);

/// The same, plus the entries of the study's design that fit on a line.
ReportSection ProvenanceSection(const Provenance& provenance, const nlohmann::ordered_json& design);

}  // namespace conav::study
