#include "planner/explain/decision_file.h"

#include <decisions.pb.h>
#include <fmt/core.h>

#include <cmath>
#include <string>

#include "common/runtime/file.h"
#include "common/segments/record_stream.h"

namespace conav::planner {
namespace {

constexpr std::uint32_t kMaxSide = 1024;
constexpr int kTerms = 7;
constexpr int kMaxActions = 4096;

using Indices = google::protobuf::RepeatedField<std::uint32_t>;

// --- to records ------------------------------------------------------------------------------

std::uint32_t IndexOf(const OccupancyGrid& map, Cell cell) {
  return static_cast<std::uint32_t>(map.IndexOf(cell));
}

void Fill(Indices& indices, const std::vector<Cell>& cells, const OccupancyGrid& map) {
  for (const Cell cell : cells) {
    if (map.Contains(cell)) indices.Add(IndexOf(map, cell));
  }
}

void Fill(decisions::Action& record, const SearchAction& action, const OccupancyGrid& map,
          bool has_terms) {
  record.set_kind(static_cast<std::uint32_t>(action.kind));
  record.set_target(IndexOf(map, action.target));
  record.set_heading(action.heading_rad);
  record.set_visits(action.visits);
  record.set_mean_value(action.mean_value);
  record.set_information_gain(action.information_gain);
  record.set_feasibility(action.feasibility);
  if (!has_terms) return;
  const RewardTerms& terms = action.terms;
  for (const double term : {terms.goals, terms.steps, terms.progress, terms.guidance,
                            terms.smoothness, terms.information, terms.communication}) {
    record.add_terms(term);
  }
}

void Fill(decisions::Tree& record, const std::vector<ReportedNode>& tree,
          const OccupancyGrid& map) {
  for (const ReportedNode& node : tree) {
    record.add_parent(node.parent);
    record.add_kind(static_cast<std::uint32_t>(node.kind));
    record.add_target(IndexOf(map, node.target));
    record.add_heading(node.heading_rad);
    record.add_visits(node.visits);
    record.add_mean_value(node.mean_value);
    record.add_feasibility(node.feasibility);
  }
}

void Fill(decisions::Views& record, const std::vector<ReportedView>& views,
          const OccupancyGrid& map) {
  for (const ReportedView& view : views) {
    record.add_cell(IndexOf(map, view.cell));
    record.add_heading(view.heading_rad);
    record.add_information_gain(view.information_gain);
  }
}

void FillReport(decisions::Decision& record, const SearchReport& report, const OccupancyGrid& map) {
  record.set_stamp(report.stamp.nanoseconds);
  record.set_world(report.world);
  record.set_robot(report.robot);
  record.set_method(report.method);
  record.set_number(report.decision);
  record.set_cell(IndexOf(map, report.cell));
  record.set_belief_revision(report.belief_revision);
  record.set_guidance_revision(report.guidance_revision);
  for (const SearchAction& action : report.actions) {
    Fill(*record.add_actions(), action, map, report.has_terms);
  }
  record.set_chosen(report.chosen);
  record.set_has_terms(report.has_terms);
  if (!report.tree.empty()) Fill(*record.mutable_tree(), report.tree, map);
  if (!report.views.empty()) Fill(*record.mutable_views(), report.views, map);
  record.set_iterations(report.iterations);
  record.set_nodes(report.nodes);
  record.set_perception_queries(report.perception_queries);
  record.set_perception_cached(report.perception_cached);
  record.set_perception_model(report.perception_model);
  record.set_duration_ms(report.duration_ms);
}

// --- from records ----------------------------------------------------------------------------

/// Collects the first thing that is wrong with a record.
class Reader {
 public:
  explicit Reader(const decisions::Decision& record) : record_(record) {}

  Result<DecisionRecord> Read() {
    if (ReadMaps()) {
      ReadSituation();
      ReadReport();
    }
    if (!error_.empty()) return Fail(ErrorCode::kMalformed, error_);
    return std::move(decision_);
  }

 private:
  template <class... Values>
  void Refuse(fmt::format_string<Values...> text, Values&&... values) {
    if (error_.empty()) error_ = fmt::format(text, std::forward<Values>(values)...);
  }

  bool ReadMaps() {
    if (record_.rows() < 1 || record_.columns() < 1 || record_.rows() > kMaxSide ||
        record_.columns() > kMaxSide) {
      Refuse("the map is {} x {}; each side must be in [1, {}]", record_.rows(), record_.columns(),
             kMaxSide);
      return false;
    }
    const std::size_t cells = std::size_t{record_.rows()} * record_.columns();
    const auto believed = static_cast<std::size_t>(record_.belief_size());
    if (record_.map().size() != cells || (believed != cells && believed != 0)) {
      Refuse("{} cells of the robot's map and {} of the operator's where {} x {} are said",
             record_.map().size(), record_.belief_size(), record_.rows(), record_.columns());
      return false;
    }
    const int rows = static_cast<int>(record_.rows());
    const int columns = static_cast<int>(record_.columns());
    decision_.map = OccupancyGrid(rows, columns);
    if (believed != 0) decision_.belief = BeliefGrid(rows, columns);
    for (std::size_t i = 0; i < cells; ++i) ReadMapCell(i);
    for (std::size_t i = 0; i < believed; ++i) ReadBeliefCell(i);
    return true;
  }

  void ReadMapCell(std::size_t i) {
    const auto value = static_cast<std::uint8_t>(record_.map()[i]);
    if (value > 2) Refuse("the map has the value {}", value);
    decision_.map.values()[i] = static_cast<Occupancy>(value);
  }

  void ReadBeliefCell(std::size_t i) {
    const float wall = record_.belief(static_cast<int>(i));
    if (!(wall >= 0.0F && wall <= 1.0F)) Refuse("the belief {} is outside of [0, 1]", wall);
    decision_.belief.values()[i] = wall;
  }

  Cell ReadCell(std::string_view what, std::uint32_t index) {
    if (index < decision_.map.size()) return decision_.map.CellAt(index);
    Refuse("{}: there is no cell {}", what, index);
    return {};
  }

  std::vector<Cell> ReadCells(std::string_view what, const Indices& indices) {
    std::vector<Cell> cells;
    for (const std::uint32_t index : indices) cells.push_back(ReadCell(what, index));
    return cells;
  }

  double ReadNumber(std::string_view what, double value) {
    if (!std::isfinite(value)) Refuse("{}: {} is no number", what, value);
    return value;
  }

  CommandKind ReadKind(std::string_view what, std::uint32_t kind,
                       CommandKind last = CommandKind::kTransmitView) {
    const bool known = kind >= static_cast<std::uint32_t>(CommandKind::kMove) &&
                       kind <= static_cast<std::uint32_t>(last);
    if (!known) Refuse("{}: there is no action of kind {}", what, kind);
    return static_cast<CommandKind>(kind);
  }

  void ReadSituation() {
    decision_.goals_left = ReadCells("goals", record_.goals_left());
    decision_.path = ReadCells("path", record_.path());
    decision_.guidance = ReadCells("guidance", record_.guidance());
    decision_.plan = ReadCells("plan", record_.plan());
    decision_.taken = ReadAction("taken", record_.taken(), CommandKind::kDrive);
  }

  /// `last`: of the kinds that it can be.
  SearchAction ReadAction(std::string_view what, const decisions::Action& record,
                          CommandKind last = CommandKind::kTransmitView) {
    SearchAction action;
    action.kind = ReadKind(what, record.kind(), last);
    action.target = ReadCell(what, record.target());
    action.heading_rad = ReadNumber(what, record.heading());
    action.visits = record.visits();
    action.mean_value = ReadNumber(what, record.mean_value());
    action.information_gain = ReadNumber(what, record.information_gain());
    action.feasibility = ReadNumber(what, record.feasibility());
    if (record.terms_size() == 0) return action;
    if (record.terms_size() != kTerms) {
      Refuse("{}: {} terms where {} make a value", what, record.terms_size(), kTerms);
      return action;
    }
    const auto term = [&](int index) { return ReadNumber(what, record.terms(index)); };
    action.terms = {term(0), term(1), term(2), term(3), term(4), term(5), term(6)};
    return action;
  }

  void ReadReport() {
    SearchReport& report = decision_.report;
    report.stamp = SimTime{record_.stamp()};
    report.world = record_.world();
    report.robot = record_.robot();
    report.method = record_.method();
    report.decision = record_.number();
    report.cell = ReadCell("robot", record_.cell());
    report.belief_revision = record_.belief_revision();
    report.guidance_revision = record_.guidance_revision();
    ReadActions(report);
    report.has_terms = record_.has_terms();
    ReadTree(report);
    ReadViews(report);
    report.iterations = record_.iterations();
    report.nodes = record_.nodes();
    report.perception_queries = record_.perception_queries();
    report.perception_cached = record_.perception_cached();
    report.perception_model = record_.perception_model();
    report.duration_ms = ReadNumber("duration", record_.duration_ms());
  }

  void ReadActions(SearchReport& report) {
    if (record_.actions_size() > kMaxActions) {
      return Refuse("{} actions, more than {}", record_.actions_size(), kMaxActions);
    }
    for (const auto& action : record_.actions()) {
      report.actions.push_back(ReadAction("action", action));
    }
    report.chosen = record_.chosen();
    if (report.chosen < -1 || report.chosen >= record_.actions_size()) {
      Refuse("chosen: there is no action {}", report.chosen);
    }
  }

  void ReadTree(SearchReport& report) {
    const decisions::Tree& tree = record_.tree();
    const int size = tree.parent_size();
    for (const int column : {tree.kind_size(), tree.target_size(), tree.heading_size(),
                             tree.visits_size(), tree.mean_value_size(), tree.feasibility_size()}) {
      if (column != size) return Refuse("tree: columns of {} and {} nodes", size, column);
    }
    for (int i = 0; i < size; ++i) {
      const int parent = tree.parent(i);
      if (i == 0 ? parent != -1 : parent < 0 || parent >= i) {
        return Refuse("tree: node {} cannot have the parent {}", i, parent);
      }
      report.tree.push_back({parent, ReadKind("tree", tree.kind(i)),
                             ReadCell("tree", tree.target(i)), ReadNumber("tree", tree.heading(i)),
                             tree.visits(i), ReadNumber("tree", tree.mean_value(i)),
                             ReadNumber("tree", tree.feasibility(i))});
    }
  }

  void ReadViews(SearchReport& report) {
    const decisions::Views& views = record_.views();
    if (views.heading_size() != views.cell_size() ||
        views.information_gain_size() != views.cell_size()) {
      return Refuse("views: columns of different lengths");
    }
    for (int i = 0; i < views.cell_size(); ++i) {
      report.views.push_back({ReadCell("views", views.cell(i)),
                              ReadNumber("views", views.heading(i)),
                              ReadNumber("views", views.information_gain(i))});
    }
  }

  const decisions::Decision& record_;
  DecisionRecord decision_;
  std::string error_;
};

}  // namespace

decisions::Record HeaderRecord() {
  decisions::Record record;
  record.mutable_header()->set_schema_version(kDecisionSchemaVersion);
  return record;
}

decisions::Record ToRecord(const DecisionRecord& decision) {
  decisions::Record record;
  decisions::Decision& out = *record.mutable_decision();
  const OccupancyGrid& map = decision.map;
  out.set_rows(static_cast<std::uint32_t>(map.rows()));
  out.set_columns(static_cast<std::uint32_t>(map.columns()));
  for (const Occupancy value : map.values()) {
    out.mutable_map()->push_back(static_cast<char>(value));
  }
  out.mutable_belief()->Add(decision.belief.values().begin(), decision.belief.values().end());
  Fill(*out.mutable_goals_left(), decision.goals_left, map);
  Fill(*out.mutable_path(), decision.path, map);
  Fill(*out.mutable_guidance(), decision.guidance, map);
  Fill(*out.mutable_plan(), decision.plan, map);
  Fill(*out.mutable_taken(), decision.taken, map, false);
  FillReport(out, decision.report, map);
  return record;
}

Result<DecisionRecord> FromRecord(const decisions::Decision& record) {
  return Reader(record).Read();
}

namespace {

constexpr std::string_view kKind = "decision file";

tl::unexpected<Error> Refuse(const std::string& reason) {
  return Fail(ErrorCode::kMalformed, reason);
}

Result<void> ReadHeader(RecordReader& reader) {
  decisions::Record record;
  const auto more = reader.Next(record);
  if (!more) return tl::unexpected(more.error());
  if (!*more || !record.has_header()) {
    return Refuse("it does not begin with a header: this is no decision file");
  }
  const std::uint32_t version = record.header().schema_version();
  if (version == kDecisionSchemaVersion) return {};
  return Refuse(
      fmt::format("schema version {}; this program reads {}", version, kDecisionSchemaVersion));
}

Result<void> ReadRecords(std::string_view frames,
                         const std::function<void(DecisionRecord&&)>& take) {
  RecordReader reader(frames, kKind);
  if (auto header = ReadHeader(reader); !header) return header;
  decisions::Record record;
  for (std::size_t number = 1;; ++number) {
    const auto more = reader.Next(record);
    if (!more) return tl::unexpected(more.error());
    if (!*more) return {};
    auto decision = FromRecord(record.decision());
    if (!decision) return Refuse(fmt::format("record {}: {}", number, decision.error().text));
    take(*std::move(decision));
  }
}

Result<bool> ReadFrames(std::string_view file, const std::function<void(DecisionRecord&&)>& take) {
  if (file.empty()) return Refuse("it is empty");
  const auto frames = FindFrames(file);
  if (!frames) return tl::unexpected(frames.error());
  if (frames->complete_bytes == 0) return Refuse("it has no complete zstd frame");
  return ReadRecords(file.substr(0, frames->complete_bytes), take).map([&] {
    return frames->torn;
  });
}

template <class T>
Result<T> WithPath(const std::filesystem::path& path, Result<T> result) {
  if (result) return result;
  return Fail(result.error().code, fmt::format("{}: {}", path.string(), result.error().text));
}

}  // namespace

Result<bool> ReadDecisions(const std::filesystem::path& path,
                           const std::function<void(DecisionRecord&&)>& take) {
  const auto file = ReadFile(path);
  if (!file) return tl::unexpected(file.error());
  return WithPath(path, ReadFrames(*file, take));
}

namespace {

constexpr int kCompressionLevel = 3;  // a robot waits for it

std::string FrameOf(const decisions::Record& record) {
  ZstdFrame frame(kCompressionLevel);
  frame.Add(Delimited(record));
  return frame.Finish();
}

}  // namespace

Result<DecisionLog> DecisionLog::Open(const std::filesystem::path& path) {
  auto opened = FrameLog::Open(path, [&](std::string_view frames) {
    RecordReader reader(frames, kKind);
    return WithPath(path, ReadHeader(reader));
  });
  if (!opened) return tl::unexpected(opened.error());
  DecisionLog log(*std::move(opened));
  if (!log.log_.empty()) return log;
  return log.log_.Append(FrameOf(HeaderRecord())).map([&] { return std::move(log); });
}

Result<void> DecisionLog::Append(const DecisionRecord& decision) {
  return log_.Append(FrameOf(ToRecord(decision)));
}

}  // namespace conav::planner
