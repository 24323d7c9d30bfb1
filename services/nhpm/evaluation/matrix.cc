#include "nhpm/evaluation/matrix.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "common/cli/cli.h"
#include "common/cli/progress_line.h"
#include "common/runtime/file.h"
#include "common/runtime/text.h"
#include "common/segments/segment_file.h"
#include "common/segments/segment_split.h"
#include "nhpm/dataset/synthesize.h"
#include "nhpm/evaluation/report.h"
#include "nhpm/model/perception_network.h"
#include "nhpm/model/pooled_model.h"
#include "nhpm/training/adapt.h"
#include "nhpm/training/example.h"

namespace conav::nhpm {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kPersonMazes = 40;  // that each person of an adaptation tries
constexpr std::size_t kShots[] = {5, 20, 100};
constexpr std::size_t kMostPersonTests = 5;  // trajectories
/// The GLPF of the others counts as so many segments when it is fitted further to a person.
constexpr double kGlpfPriorSegments = 20.0;

struct Kind {
  std::string name;
  std::string digest;  // of the file
  std::optional<AnnotatorPopulation> population;
  SegmentSet segments;  // without a population
};
using Kinds = std::vector<const Kind*>;

std::string NameOf(const std::filesystem::path& file) {
  std::string name = file.filename().string();
  return name.substr(0, name.find('.'));
}

Result<Kind> LoadKind(const std::string& file) {
  Kind kind{NameOf(file), {}, {}, {}};
  if (!file.ends_with(".yaml")) {
    return ReadIdentifiedSegments(file).map([&](IdentifiedSegments&& read) {
      kind.digest = read.checksum;
      kind.segments = std::move(read.set);
      return kind;
    });
  }
  const auto text = ReadFile(file);
  if (!text) return tl::unexpected(text.error());
  try {
    kind.population = ReadPopulation(file);
  } catch (const StartupError& error) {
    return Fail(ErrorCode::kInvalidArgument, error.what());
  }
  kind.digest = Sha256Hex(*text);
  return kind;
}

/// A part of an adaptation's person.
struct PersonParts {
  SegmentSet learned;  // the longest shot
  SegmentSet tested;
};

/// Enough trajectories of one person for all shots, and others to test on; else nothing.
std::optional<PersonParts> PartsOf(const Person& person) {
  PersonParts parts;
  for (const Trajectory& trajectory : person.set.trajectories) {
    SegmentSet& part =
        SegmentCount(parts.learned) < std::ranges::max(kShots) ? parts.learned : parts.tested;
    if (part.trajectories.size() < kMostPersonTests || &part == &parts.learned) {
      part.trajectories.push_back(trajectory);
    }
  }
  if (parts.tested.trajectories.size() < 2) return std::nullopt;
  return parts;
}

class Matrix {
 public:
  Matrix(const MatrixArguments& arguments, const StopToken& stop)
      : arguments_(arguments), stop_(stop) {
    inputs_.depth = arguments.view_encoding == "depth";
  }

  Result<Json> Run();

 private:
  Result<void> Load();
  Result<Json> Cell(const std::string& train_name, const Kinds& train, const Kind& test, int count);
  Result<Json> Limits(const Kind& test);
  /// Adds what models lose on one person to `sums`; the GLPF of the others is fitted to `others`.
  using AddOne = Result<void> (Matrix::*)(const PersonParts& parts, const NetworkModel& base,
                                          const GlpfStatistics& others, Json& sums);
  Result<Json> Adaptation(const Kind& test);
  Result<Json> PeopleMeans(const std::string& what, const Kind& test, AddOne add_one);
  Result<void> AddPerson(const PersonParts& parts, const NetworkModel& base,
                         const GlpfStatistics& others, Json& sums);
  Result<void> AddPool(const PersonParts& parts, const NetworkModel& base,
                       const GlpfStatistics& others, Json& sums);
  Result<SegmentSet> Synthesize(const Kind& kind, std::uint64_t seed, int count, int per_person);
  Result<SegmentSet> TrainSet(const Kinds& kinds, int count);
  Result<SegmentSet> TestSet(const Kind& kind);
  Result<NetworkModel> Learn(const std::string& name, const Kinds& kinds, int count);
  Result<double> MbceOf(PerceptionModel& model, const SegmentSet& set);
  Result<Json> Cached(const std::string& what, const std::function<Result<Json>()>& compute);
  Kinds OthersOf(const Kind& kind) const;
  std::string TrainingKey(const Kinds& kinds, int count) const;
  std::string TestKey(const Kind& kind) const;

  const MatrixArguments& arguments_;
  const StopToken& stop_;
  InputSelection inputs_;
  std::map<std::string, Kind> kinds_;  // by file
  std::map<std::string, GlpfStatistics> statistics_;
  ProgressLine progress_;
  std::string piece_;
};

Result<void> Matrix::Load() {
  for (const auto& files : {arguments_.train_on, arguments_.test_on}) {
    for (const std::string& file : files) {
      if (file == kOthers || kinds_.contains(file)) continue;
      auto kind = LoadKind(file);
      if (!kind) return tl::unexpected(kind.error());
      kinds_.emplace(file, *std::move(kind));
    }
  }
  return {};
}

Kinds Matrix::OthersOf(const Kind& kind) const {
  Kinds others;
  for (const std::string& file : arguments_.test_on) {
    if (const Kind& other = kinds_.at(file); &other != &kind) others.push_back(&other);
  }
  return others;
}

std::string Matrix::TrainingKey(const Kinds& kinds, int count) const {
  const TrainingOptions& options = arguments_.training;
  std::string key = fmt::format("{} {} {} {} {} {} {}", count, arguments_.seed, options.width,
                                options.epochs, options.batch, options.learning_rate, options.seed);
  if (!inputs_.depth) key += " mask";
  for (const Kind* kind : kinds) key += " " + kind->digest;
  return key;
}

std::string Matrix::TestKey(const Kind& kind) const {
  return fmt::format("{} {} {}", arguments_.test_trajectories, arguments_.seed, kind.digest);
}

Result<SegmentSet> Matrix::Synthesize(const Kind& kind, std::uint64_t seed, int count,
                                      int per_person) {
  SynthesisOptions options;
  options.trajectories = count;
  options.seed = seed;
  options.population = *kind.population;
  options.trajectories_per_person = per_person;
  options.threads = arguments_.threads;
  auto made = SynthesizeSegments(options);
  if (!made) return Fail(made.error().code, kind.name + ": " + made.error().text);
  return std::move(made->set);
}

constexpr SplitShares kSegmentShares{.test = 0.3};  // of segment files

Result<SegmentSet> Matrix::TrainSet(const Kinds& kinds, int count) {
  SegmentSet all;
  for (const Kind* kind : kinds) {
    Result<SegmentSet> set = SegmentSet();
    if (kind->population) {
      set = Synthesize(*kind, arguments_.seed, count, 3);
      if (!set) return set;
    } else {
      SegmentSplit split = SplitSegments(kind->segments, kDefaultSplitSeed, kSegmentShares);
      *set = std::move(split.train);
      std::ranges::move(split.validation.trajectories, std::back_inserter(set->trajectories));
      if (set->trajectories.size() > static_cast<std::size_t>(count)) {
        set->trajectories.resize(static_cast<std::size_t>(count));
      }
    }
    std::ranges::move(set->trajectories, std::back_inserter(all.trajectories));
  }
  return all;
}

Result<SegmentSet> Matrix::TestSet(const Kind& kind) {
  if (!kind.population) {
    return SplitSegments(kind.segments, kDefaultSplitSeed, kSegmentShares).test;
  }
  return Synthesize(kind, arguments_.seed + 1, arguments_.test_trajectories, 1);
}

Result<Json> Matrix::Cached(const std::string& what, const std::function<Result<Json>()>& compute) {
  const auto path = arguments_.cache / (Sha256Hex(what).substr(0, 16) + ".json");
  if (const auto text = ReadFile(path)) {
    auto json = Json::parse(*text, nullptr, false);
    if (!json.is_discarded()) return json;
  }
  if (stop_.stop_requested()) {
    return Fail(ErrorCode::kUnavailable, "stopped; the same command continues");
  }
  auto json = compute();
  if (!json) return json;
  if (const auto written = WriteFile(path, json->dump()); !written) {
    return tl::unexpected(written.error());
  }
  return json;
}

Result<NetworkModel> Matrix::Learn(const std::string& name, const Kinds& kinds, int count) {
  const auto path =
      arguments_.cache /
      fmt::format("{}-{}.nhpm", name, Sha256Hex(TrainingKey(kinds, count)).substr(0, 16));
  if (std::filesystem::exists(path)) return ReadWeightsFile(path);
  const auto set = TrainSet(kinds, count);
  if (!set) return tl::unexpected(set.error());
  if (const auto one = CheckOneSize(*set); !one) return tl::unexpected(one.error());
  const SegmentSplit split = SplitSegments(*set, kDefaultSplitSeed, {.test = 0.0});
  const ExampleSet train = ExamplesOf(split.train, inputs_);
  const ExampleSet validation = ExamplesOf(split.validation, inputs_);
  if (train.examples.empty() || validation.examples.empty()) {
    return Fail(ErrorCode::kInvalidArgument, name + ": too few trajectories to learn from");
  }
  Trainer trainer(arguments_.training, train, validation, arguments_.threads,
                  InitialTrainingState(arguments_.training, EditShare(train)));
  while (!trainer.finished()) {
    const auto epoch = trainer.RunEpoch(stop_);
    if (!epoch) return Fail(ErrorCode::kUnavailable, "stopped; the same command continues");
    progress_.ShowNowAndThen(fmt::format("{}: learning from {} ({} segments), epoch {} of {}",
                                         piece_, name, train.examples.size(), epoch->epoch,
                                         arguments_.training.epochs));
  }
  NetworkModel model;
  model.version = fmt::format("matrix, {} of {}", name, kinds.size());
  model.weights = trainer.state().best;
  model.inputs = inputs_;
  model.data_origin = OriginText(*set);
  model.learned_from = FingerprintsOf(*set);
  if (const auto written = WriteWeightsFile(path, model); !written) {
    return tl::unexpected(written.error());
  }
  return model;
}

Json MetricsJson(const std::string& model, const ModelRow& row) {
  return {{model + "_mbce", row.test.loss.all}, {model + "_iou", row.test.best.iou}};
}

Result<Json> Matrix::Cell(const std::string& train_name, const Kinds& train, const Kind& test,
                          int count) {
  const std::string training = TrainingKey(train, count);
  auto cell = Cached("cell 3 " + training + TestKey(test), [&]() -> Result<Json> {
    const auto learned =
        Learn(train_name == kOthers ? "without-" + test.name : train_name, train, count);
    if (!learned) return tl::unexpected(learned.error());
    EvaluationData data;
    auto tested = TestSet(test);
    if (!tested) return tl::unexpected(tested.error());
    data.test = *std::move(tested);
    const auto network = std::make_shared<PerceptionNetwork>(*learned);
    const auto nhpm = EvaluateModel({"nhpm", "NHPM", ""}, *network, data);
    if (!nhpm) return tl::unexpected(nhpm.error());
    if (!statistics_.contains(training)) {
      const auto set = TrainSet(train, count);
      if (!set) return tl::unexpected(set.error());
      statistics_[training] = CountStimuli(AllSegments(*set));
    }
    const auto formula = std::make_shared<Glpf>(FitGlpf(statistics_[training]).best.parameters);
    const auto glpf = EvaluateModel({"glpf", "GLPF", ""}, *formula, data);
    if (!glpf) return tl::unexpected(glpf.error());
    PooledPerceptionModel pool(network, formula);
    const auto pooled = EvaluateModel({"pool", "Pool", ""}, pool, data);
    if (!pooled) return tl::unexpected(pooled.error());
    Json json = MetricsJson("nhpm", *nhpm);
    json["nhpm_ece"] = nhpm->test.calibration.error;
    json["nhpm_reliability"] = ReliabilityJson(nhpm->test.calibration);
    json.update(MetricsJson("glpf", *glpf));
    json.update(MetricsJson("pool", *pooled));
    return json;
  });
  const auto limits = Limits(test);
  if (!limits) return limits;
  if (cell) cell->update(*limits);
  return cell;
}

Result<Json> Matrix::Limits(const Kind& test) {
  return Cached(
      fmt::format("limits {} {}", arguments_.oracle_draws, TestKey(test)), [&]() -> Result<Json> {
        EvaluationData data;
        auto tested = TestSet(test);
        if (!tested) return tl::unexpected(tested.error());
        data.test = *std::move(tested);
        const auto glpf = EvaluateGlpfTest(data);
        if (!glpf) return tl::unexpected(glpf.error());
        Json json = MetricsJson("glpf_test", *glpf);
        json["oracle_mbce"] = nullptr;
        json["oracle_iou"] = nullptr;
        if (!test.population || arguments_.oracle_draws == 0) return json;
        OracleOptions options{.draws = arguments_.oracle_draws, .threads = arguments_.threads};
        options.progress = [&](std::size_t done, std::size_t total) {
          progress_.ShowNowAndThen(fmt::format("{}: oracle {} of {}", piece_, done, total));
        };
        const auto by_trajectory = OracleAnswers(data.test.trajectories, options);
        if (!by_trajectory) return tl::unexpected(by_trajectory.error());
        std::vector<PerceptionAnswer> answers;
        for (const auto& some : *by_trajectory)
          std::ranges::copy(some, std::back_inserter(answers));
        const auto oracle = EvaluateAnswers({"oracle", "Oracle", ""}, {}, std::move(answers), data);
        if (!oracle) return tl::unexpected(oracle.error());
        json.update(MetricsJson("oracle", *oracle));
        return json;
      });
}

Result<double> Matrix::MbceOf(PerceptionModel& model, const SegmentSet& set) {
  EvaluationData data;
  data.test = set;
  return EvaluateModel({}, model, data).map([](const ModelRow& row) { return row.test.loss.all; });
}

/// Adds one person's losses to `sums`. `others` counts as kGlpfPriorSegments.
Result<void> Matrix::AddPerson(const PersonParts& parts, const NetworkModel& base,
                               const GlpfStatistics& others, Json& sums) {
  const auto add = [&](const std::string& name, PerceptionModel& model) -> Result<void> {
    const auto loss = MbceOf(model, parts.tested);
    if (!loss) return tl::unexpected(loss.error());
    sums[name] = sums.value(name, 0.0) + *loss;
    return {};
  };
  PerceptionNetwork unadapted(base);
  Glpf transferred(FitGlpf(others).best.parameters);
  if (const auto done = add("0", unadapted); !done) return done;
  if (const auto done = add("glpf", transferred); !done) return done;
  for (const std::size_t shot : kShots) {
    const SegmentSet learned = FirstSegments(parts.learned, shot);
    auto adapted =
        Adapt(base.weights, AdaptationGroups(learned, base.inputs), {}, arguments_.threads, stop_);
    if (!adapted) return tl::unexpected(adapted.error());
    NetworkModel model = base;
    model.weights = std::move(adapted->weights);
    PerceptionNetwork network(model);
    if (const auto done = add(std::to_string(shot), network); !done) return done;
    Glpf fitted(
        FitGlpf(WeightedSum(others, 1.0, CountStimuli(AllSegments(learned)))).best.parameters);
    if (const auto done = add(fmt::format("glpf_{}", shot), fitted); !done) return done;
  }
  return {};
}

/// The same for a pool whose weights learn from the segments.
Result<void> Matrix::AddPool(const PersonParts& parts, const NetworkModel& base,
                             const GlpfStatistics& others, Json& sums) {
  PooledPerceptionModel pool(std::make_shared<PerceptionNetwork>(base),
                             std::make_shared<Glpf>(FitGlpf(others).best.parameters));
  const std::vector<const Segment*> learned = AllSegments(parts.learned);
  std::size_t seen = 0;
  for (const std::size_t shot : {std::size_t{0}, kShots[0], kShots[1], kShots[2]}) {
    for (; seen < std::min(shot, learned.size()); ++seen) {
      pool.ReceivedEdits(learned[seen]->query, learned[seen]->belief_after);
    }
    const auto loss = MbceOf(pool, parts.tested);
    if (!loss) return tl::unexpected(loss.error());
    const std::string name = fmt::format("pool_{}", shot);
    sums[name] = sums.value(name, 0.0) + *loss;
  }
  return {};
}

Result<Json> Matrix::Adaptation(const Kind& test) {
  auto adapted = PeopleMeans("adaptation 1", test, &Matrix::AddPerson);
  const auto pooled = PeopleMeans("pool 2", test, &Matrix::AddPool);
  if (adapted && pooled) adapted->update(*pooled);
  return pooled ? adapted : pooled;
}

Result<Json> Matrix::PeopleMeans(const std::string& what, const Kind& test, AddOne add_one) {
  const Kinds others = OthersOf(test);
  const std::string training = TrainingKey(others, arguments_.trajectories);
  return Cached(
      fmt::format("{} {} {} {}", what, arguments_.people, training, TestKey(test)),
      [&]() -> Result<Json> {
        const auto base = Learn("without-" + test.name, others, arguments_.trajectories);
        if (!base) return tl::unexpected(base.error());
        const auto set = TrainSet(others, arguments_.trajectories);
        if (!set) return tl::unexpected(set.error());
        const GlpfStatistics statistics =
            WeightedSum(CountStimuli(AllSegments(*set)),
                        kGlpfPriorSegments / static_cast<double>(SegmentCount(*set)), {});
        Result<SegmentSet> own = test.segments;
        if (test.population) {
          own =
              Synthesize(test, arguments_.seed + 2, kPersonMazes * arguments_.people, kPersonMazes);
        }
        if (!own) return tl::unexpected(own.error());
        Json sums = Json::object();
        int people = 0;
        for (const Person& person : PeopleOf(*own)) {
          const auto parts = PartsOf(person);
          if (!parts) continue;
          progress_.ShowNowAndThen(fmt::format("{}: adapting to person {}", piece_, people + 1));
          const auto added = (this->*add_one)(*parts, *base, statistics, sums);
          if (!added) return tl::unexpected(added.error());
          if (++people == arguments_.people) break;
        }
        if (people == 0) {
          Warn(kProgram, fmt::format("{}: nobody has {} segments and two trajectories more",
                                     test.name, std::ranges::max(kShots)));
        }
        for (auto& [name, sum] : sums.items()) sum = sum.get<double>() / people;
        sums["people"] = people;
        return sums;
      });
}

/// Whether at least `share` of the kinds are good.
Json BarOf(int good, std::size_t kinds, double share) {
  const int limit = static_cast<int>(std::ceil(share * static_cast<double>(kinds)));
  return {{"value", good}, {"limit", limit}, {"kinds", kinds}, {"passed", good >= limit}};
}

Result<Json> Matrix::Run() {
  if (const auto loaded = Load(); !loaded) return tl::unexpected(loaded.error());
  std::error_code ignored;
  std::filesystem::create_directories(arguments_.cache, ignored);
  Json json{{"schema", 1}, {"matrix", Json::object()}};
  json["settings"] = {{"trajectories", arguments_.trajectories},
                      {"test_trajectories", arguments_.test_trajectories},
                      {"view_encoding", arguments_.view_encoding},
                      {"width", arguments_.training.width},
                      {"epochs", arguments_.training.epochs},
                      {"seed", arguments_.seed}};
  const std::size_t pieces = arguments_.train_on.size() * arguments_.test_on.size() +
                             arguments_.test_on.size() * (arguments_.curve.size() + 1);
  std::size_t done = 0;
  const auto next = [&](const std::string& what) {
    piece_ = fmt::format("{} of {}, {}", ++done, pieces, what);
    progress_.ShowNowAndThen(piece_);
  };
  int no_worse = 0;
  int pool_no_worse = 0;
  int better = 0;
  std::size_t adapted = 0;
  for (const std::string& test_file : arguments_.test_on) {
    const Kind& test = kinds_.at(test_file);
    for (const std::string& file : arguments_.train_on) {
      const bool others = file == kOthers;
      const std::string name = others ? kOthers : kinds_.at(file).name;
      next(name + " on " + test.name);
      const auto cell = Cell(name, others ? OthersOf(test) : Kinds{&kinds_.at(file)}, test,
                             arguments_.trajectories);
      if (!cell) return cell;
      json["matrix"][name][test.name] = *cell;
      no_worse += others && (*cell)["nhpm_mbce"] <= (*cell)["glpf_mbce"];
      pool_no_worse += others && (*cell)["pool_mbce"] <= (*cell)["glpf_mbce"];
    }
    for (const int count : arguments_.curve) {
      next(fmt::format("{} with {} trajectories", test.name, count));
      const auto cell = Cell(test.name, {&test}, test, count);
      if (!cell) return cell;
      json["curve"][test.name][std::to_string(count)] = *cell;
    }
    next("people of " + test.name);
    if (arguments_.people == 0) continue;
    const auto adaptation = Adaptation(test);
    if (!adaptation) return adaptation;
    json["adaptation"][test.name] = *adaptation;
    adapted += adaptation->value("people", 0) > 0;
    better += adaptation->value("20", 1.0) < adaptation->value("glpf", 0.0);
  }
  const std::size_t kinds = arguments_.test_on.size();
  if (json["matrix"].contains(kOthers)) {
    json["bars"]["strangers_no_worse_than_glpf"] = BarOf(no_worse, kinds, 7.0 / 8.0);
    json["bars"]["pool_no_worse_than_glpf"] = BarOf(pool_no_worse, kinds, 7.0 / 8.0);
  }
  if (adapted > 0) {
    json["bars"]["better_than_glpf_after_20"] = BarOf(better, adapted, 5.0 / 8.0);
  }
  return json;
}

}  // namespace

Result<Json> ComputeMatrix(const MatrixArguments& arguments, const StopToken& stop) {
  return Matrix(arguments, stop).Run();
}

}  // namespace conav::nhpm
