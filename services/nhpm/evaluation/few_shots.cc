#include "nhpm/evaluation/few_shots.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>

#include "nhpm/dataset/synthesize.h"
#include "nhpm/model/perception_network.h"
#include "nhpm/model/weighed_model.h"

namespace conav::nhpm {
namespace {

constexpr std::size_t kShots[] = {5, 20, 100};
constexpr std::size_t kMostPersonTests = 5;  // trajectories
/// The GLPF of the others counts as so many segments when it is fitted further to a person.
constexpr double kGlpfPriorSegments = 20.0;

/// A part of an adaptation's person.
struct PersonParts {
  SegmentSet learned;  // the longest shot
  SegmentSet tested;
};

/// The first so many segments.
SegmentSet FirstSegments(const SegmentSet& set, std::size_t count) {
  SegmentSet first;
  for (const Trajectory& trajectory : set.trajectories) {
    const std::size_t left = count - SegmentCount(first);
    if (left == 0) break;
    first.trajectories.push_back(trajectory);
    auto& segments = first.trajectories.back().segments;
    if (segments.size() > left) segments.resize(left);
  }
  return first;
}

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

void AddStatistics(const StimulusCount& from, double factor, StimulusCount& to) {
  to.outputs += factor * from.outputs;
  to.edits += factor * from.edits;
}

GlpfStatistics Sum(const GlpfStatistics& a, double factor, const GlpfStatistics& b) {
  GlpfStatistics sum = b;
  for (const auto& [distance, count] : a.seen) AddStatistics(count, factor, sum.seen[distance]);
  for (const auto& [distance, count] : a.on_path) {
    AddStatistics(count, factor, sum.on_path[distance]);
  }
  AddStatistics(a.unstimulated, factor, sum.unstimulated);
  return sum;
}

using Answers = std::vector<PerceptionAnswer>;

Result<double> MbceOf(Answers answers, const SegmentSet& set) {
  EvaluationData data;
  data.test = set;
  return EvaluateAnswers({}, {}, std::move(answers), data).map([](const ModelRow& row) {
    return row.test.loss.all;
  });
}

Result<Answers> OracleOf(const SegmentSet& set, int threads) {
  return OracleAnswers(set.trajectories, {.draws = 5000, .threads = threads})
      .map([](const std::vector<Answers>& by_trajectory) {
        Answers all;
        for (const Answers& some : by_trajectory) std::ranges::copy(some, std::back_inserter(all));
        return all;
      });
}

/// The share of the network after it has seen how the person edited.
double ShareAfter(const NetworkModel& network, const GlpfParameters& glpf, const SegmentSet& seen) {
  WeighedPerceptionModel both(std::make_shared<PerceptionNetwork>(network),
                              std::make_shared<Glpf>(glpf));
  for (const Segment* segment : AllSegments(seen)) {
    both.ReceivedEdits(segment->query, segment->belief_after);
  }
  return both.share();
}

}  // namespace

Result<std::map<std::string, double>> FewShotLosses(const Person& person,
                                                    const FewShotModels& models, int threads,
                                                    const StopToken& stop) {
  std::map<std::string, double> losses;
  const auto parts = PartsOf(person);
  if (!parts) return losses;
  const auto add = [&](const std::string& name, Result<Answers> answers) -> Result<Answers> {
    if (!answers) return answers;
    const auto loss = MbceOf(*answers, parts->tested);
    if (!loss) return tl::unexpected(loss.error());
    losses[name] = *loss;
    return answers;
  };
  const auto ask = [&](PerceptionModel&& model) { return AskModel(model, parts->tested, {}); };
  const GlpfParameters transferred = FitGlpf(models.glpf).best.parameters;
  const auto glpf = add("glpf", ask(Glpf(transferred)));
  if (!glpf) return tl::unexpected(glpf.error());
  const auto unadapted = add("0", ask(PerceptionNetwork(models.network)));
  if (!unadapted) return tl::unexpected(unadapted.error());
  Result<Answers> done = add("auto_0", Mix(0.5, *unadapted, *glpf));
  const double prior = kGlpfPriorSegments / static_cast<double>(models.segments);
  for (const std::size_t shot : kShots) {
    const SegmentSet learned = FirstSegments(parts->learned, shot);
    auto adapted = Adapt(models.network.weights, AdaptationGroups(learned, models.network.inputs),
                         {}, threads, stop);
    if (!adapted) return tl::unexpected(adapted.error());
    NetworkModel model = models.network;
    model.weights = std::move(adapted->weights);
    const auto network = add(fmt::format("{}", shot), ask(PerceptionNetwork(model)));
    if (!network) return tl::unexpected(network.error());
    done = add(fmt::format("auto_{}", shot),
               Mix(ShareAfter(models.network, transferred, learned), *network, *glpf));
    if (!done) return tl::unexpected(done.error());
    const GlpfStatistics further = Sum(models.glpf, prior, CountStimuli(AllSegments(learned)));
    done = add(fmt::format("glpf_{}", shot), ask(Glpf(FitGlpf(further).best.parameters)));
    if (!done) return tl::unexpected(done.error());
  }
  if (person.set.trajectories.front().origin != SegmentOrigin::kSynthetic) return losses;
  done = add("oracle", OracleOf(parts->tested, threads));
  if (!done) return tl::unexpected(done.error());
  return losses;
}

}  // namespace conav::nhpm
