#include "operator/recorder/recorder_service.h"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <chrono>
#include <cstdlib>

#include "common/runtime/demand.h"
#include "common/runtime/log.h"
#include "operator/bag/message_schemas.h"

namespace conav::recorder {
namespace {

using namespace std::chrono_literals;

constexpr auto kPeriod = 100ms;
constexpr auto kChunkAge = 900ms;  // with the period: on disk within a second
constexpr auto kQuiet = 200ms;
constexpr auto kQuietLimit = 2s;
constexpr std::size_t kWaitingLimit = std::size_t{64} << 20;

bag::Metadata FactsOf(const bus::Participant& participant, const RecorderConfig& config) {
  bag::TextMap values = config.facts;
  const char* commit = std::getenv("CONAV_COMMIT");
  values["conav_version"] = CONAV_VERSION;
  if (commit != nullptr) values["conav_commit"] = commit;
  values["dds"] = participant.vendor();
  values["domain"] = std::to_string(config.bus.domain_id);
  values["robots"] = fmt::format("{}", fmt::join(config.robots, " "));
  values["streams"] = config.streams ? "true" : "false";
  values["excluded"] = fmt::format("{}", fmt::join(config.exclude, " "));
  const std::time_t now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  values["started"] = fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(now));
  return {"conav", values};
}

bag::McapWriter MakeWriter(const bus::Participant& participant, const RecorderConfig& config) {
  bag::McapWriter::Options options;
  options.library = std::string("conav ") + CONAV_VERSION;
  auto writer = bag::McapWriter::Create(config.file, options, {FactsOf(participant, config)});
  if (!writer) throw StartupError("recorder.file: " + writer.error().text);
  return *std::move(writer);
}

std::uint16_t AddChannel(bag::McapWriter& writer, const TopicFacts& topic) {
  const auto text = bag::ConavSchemas().TextOf(topic.type);
  DEMAND(text.has_value(), topic.type);
  return writer.AddChannel(
      {0, topic.type, "ros2msg", *text},
      {0, 0, topic.name, "cdr", {{"offered_qos_profiles", topic.offered_qos}}});
}

}  // namespace

RecorderService::RecorderService(bus::Participant& participant, const RecorderConfig& config,
                                 const Clock& clock)
    : participant_(participant),
      clock_(clock),
      file_(config.file),
      writer_(MakeWriter(participant, config)),
      arrivals_(kWaitingLimit, [&participant] { participant.Wake(); }),
      failures_logged_(10s),
      diagnostics_(participant, clock) {
  listeners_.emplace(
      participant, config, [this](const TopicFacts& topic) { return AddChannel(writer_, topic); },
      arrivals_);
  LOG_INFO("recording", "file", file_, "topics", listeners_->topics());
}

void RecorderService::Run(const StopToken& stop) {
  while (!stop.stop_requested()) {
    participant_.Wait(kPeriod);
    Step();
  }
  const auto limit = clock_.Now() + kQuietLimit;
  auto quiet_since = clock_.Now();
  while (clock_.Now() < limit && clock_.Now() - quiet_since < kQuiet) {
    participant_.Wait(kQuiet / 4);
    if (Step()) quiet_since = clock_.Now();
  }
  Finish();
}

bool RecorderService::Step() {
  const std::vector<Arrival> arrivals = arrivals_.Take();
  for (const Arrival& arrival : arrivals) Write(arrival);
  if (writer_.pending() > 0 && clock_.Now() - chunk_since_ >= kChunkAge) {
    const std::uint64_t size = writer_.file_size();
    Note(writer_.Flush(), size);
  }
  diagnostics_.Tick([this] { return Report(); });
  return !arrivals.empty();
}

void RecorderService::Write(const Arrival& arrival) {
  if (writer_.pending() == 0) chunk_since_ = clock_.Now();
  const std::uint64_t size = writer_.file_size();
  Note(writer_.Write(arrival.channel, arrival.log_time, arrival.publish_time, arrival.data), size);
}

void RecorderService::Note(const Result<void>& written, std::uint64_t size_before) {
  if (written) {
    if (failure_ && writer_.file_size() > size_before) {
      LOG_INFO("recording goes on", "file", file_, "lost", writer_.lost());
      failure_.reset();
    }
    return;
  }
  failure_ = written.error().text;
  if (failures_logged_.Allow()) {
    LOG_ERROR("messages not recorded", "reason", *failure_, "lost", writer_.lost());
  }
}

void RecorderService::Finish() {
  listeners_.reset();
  Step();
  if (const auto finished = writer_.Finish(); !finished) {
    LOG_ERROR("the recording has no summary", "reason", finished.error().text, "lost",
              writer_.lost());
  }
  LOG_INFO("recorded", "file", file_, "messages", writer_.message_count(), "bytes",
           writer_.file_size(), "lost", writer_.lost() + arrivals_.dropped());
}

Health RecorderService::Report() const {
  const std::uint64_t lost = writer_.lost() + arrivals_.dropped();
  Health health;
  health.message = failure_ ? "messages are lost: " + *failure_ : "recording";
  if (lost > 0) health.level = Health::Level::kWarning;
  if (failure_) health.level = Health::Level::kError;
  health.values = {{"file", file_},
                   {"messages", std::to_string(writer_.message_count() + writer_.pending())},
                   {"bytes", std::to_string(writer_.file_size())},
                   {"lost", std::to_string(lost)},
                   {"malformed", std::to_string(listeners_ ? listeners_->malformed() : 0)}};
  return health;
}

}  // namespace conav::recorder
