#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "common/svg/svg_canvas.h"
#include "operator/statistics/report.h"
#include "operator/statistics/report_plot.h"
#include "study/report.h"

namespace conav::study {
namespace {

std::string Plot(const Measure& measure, const statistics::Analysis& analysis) {
  const statistics::PlotAxis axis{measure.title, {0.0, measure.is_share ? 1.0 : AxisLimits{}.most}};
  return fmt::format("<h2>{}</h2>\n{}", EscapeXml(measure.title),
                     statistics::PlotFigure(analysis, axis));
}

std::string Tables(const statistics::Analysis& analysis) {
  std::string html = "<details>\n<summary>All figures</summary>\n";
  for (const std::string& note : analysis.notes) html += "<p>" + EscapeXml(note) + "</p>\n";
  for (const auto& section : statistics::ReportSections(analysis)) {
    html += statistics::SectionHtml(section);
  }
  return html + "</details>\n";
}

/// Who had which method when.
statistics::ReportSection OrderSection(const Design& design) {
  statistics::ReportSection section{.title = "Order of the methods (Williams design)",
                                    .header = {"operator"}};
  for (std::size_t session = 0; session < design.methods.size(); ++session) {
    section.header.push_back(fmt::format("session {}", session + 1));
  }
  for (std::size_t subject = 0; subject < design.subjects.size(); ++subject) {
    std::vector<std::string> row{design.subjects[subject]};
    row.insert(row.end(), design.orders[subject].begin(), design.orders[subject].end());
    section.rows.push_back(std::move(row));
  }
  return section;
}

}  // namespace

std::string StudyPage(const StudyReport& report) {
  std::string html = statistics::PageHead("Study with simulated operators");
  html += "<p><strong>" + EscapeXml(Headline(report)) + ".</strong></p>\n";
  for (const auto& section : StudySections(report)) html += statistics::SectionHtml(section);
  for (std::size_t m = 0; m < Measures().size(); ++m) {
    const auto& analysis = report.summary.analyses[m].analysis;
    if (!analysis || !WasMeasured(report, Measures()[m])) continue;
    html += Plot(Measures()[m], *analysis) + Tables(*analysis);
  }
  html += statistics::SectionHtml(OrderSection(report.design));
  html += statistics::SectionHtml(ProvenanceSection(report.provenance, report.document));
  return html + "</body>\n</html>\n";
}

}  // namespace conav::study
