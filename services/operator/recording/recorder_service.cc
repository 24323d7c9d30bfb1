#include "operator/recording/recorder_service.h"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <set>
#include <span>
#include <string_view>
#include <utility>

#include "common/bus/backend.h"
#include "common/bus/topics.h"
#include "common/runtime/result.h"
#include "common/runtime/text.h"
#include "operator/recording/mcap_file.h"
#include "operator/recording/raw_topics.h"

namespace conav::recorder {

Arrivals::Arrivals(std::size_t limit_bytes, std::function<void()> wake, WallClock now)
    : limit_bytes_(limit_bytes), wake_(std::move(wake)), now_(std::move(now)) {}

void Arrivals::Add(std::uint16_t channel, std::optional<std::uint64_t> stamp, bag::Bytes data,
                   const bus::Guid& writer) {
  bool many = false;
  {
    const std::lock_guard lock(mutex_);
    if (waiting_bytes_ + data.size() > limit_bytes_) {
      ++dropped_;
      return;
    }
    waiting_bytes_ += data.size();
    many = waiting_bytes_ > limit_bytes_ / 4;
    const std::uint64_t now = now_();  // here, so that the order is that of the queue
    waiting_.push_back({channel, now, stamp.value_or(now), std::move(data), writer});
  }
  if (many) wake_();
}

std::vector<Arrival> Arrivals::Take() {
  const std::lock_guard lock(mutex_);
  waiting_bytes_ = 0;
  return std::exchange(waiting_, {});
}

std::uint64_t Arrivals::dropped() const {
  const std::lock_guard lock(mutex_);
  return dropped_;
}

std::uint64_t Arrivals::SystemTime() {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return static_cast<std::uint64_t>(std::chrono::nanoseconds(now).count());
}

void LatchedMessages::Keep(Arrival arrival) {
  std::deque<Arrival>& newest = newest_[arrival.channel];
  std::erase_if(newest, [&](const Arrival& older) { return older.writer == arrival.writer; });
  if (newest.size() >= kWriters) newest.pop_front();
  newest.push_back(std::move(arrival));
}

namespace {

// rmw_qos_history_policy_t and so on.
constexpr int kKeepLast = 1;
constexpr int kKeepAll = 2;
constexpr int kReliable = 1;
constexpr int kBestEffort = 2;
constexpr int kTransientLocal = 1;
constexpr int kVolatile = 2;

/// "Infinite" as rmw has it: the most nanoseconds in 64 bits.
constexpr const char* kNever = "{sec: 9223372036, nsec: 854775807}";

}  // namespace

std::string OfferedQosText(const bus::Qos& qos) {
  const bool reliable = qos.reliability == bus::Reliability::kReliable;
  const bool latched = qos.durability == bus::Durability::kTransientLocal;
  return fmt::format(
      "- history: {}\n  depth: {}\n  reliability: {}\n  durability: {}\n  deadline: {}\n"
      "  lifespan: {}\n  liveliness: 1\n  liveliness_lease_duration: {}\n"
      "  avoid_ros_namespace_conventions: false\n",
      qos.depth > 0 ? kKeepLast : kKeepAll, qos.depth, reliable ? kReliable : kBestEffort,
      latched ? kTransientLocal : kVolatile, kNever, kNever, kNever);
}

namespace {

bool Contains(std::span<const std::string_view> patterns, std::string_view pattern) {
  return std::ranges::find(patterns, pattern) != patterns.end();
}

/// Which topics a config leaves out.
class Choice {
 public:
  explicit Choice(const RecorderConfig& config)
      : streams_(config.streams), entries_(config.exclude.begin(), config.exclude.end()) {}

  bool Includes(std::string_view pattern, const std::string& name) {
    const bool excluded = IsExcluded(std::string(pattern)) | IsExcluded(name);
    return !excluded && (streams_ || !Contains(bus::kStreamPatterns, pattern));
  }
  /// Throws StartupError for an entry that excluded nothing.
  void CheckAllUsed() const {
    for (const std::string& entry : entries_) {
      if (used_.contains(entry)) continue;
      throw StartupError("recorder.exclude: '" + entry + "' is no topic of these robots");
    }
  }

 private:
  bool IsExcluded(const std::string& entry) {
    if (!entries_.contains(entry)) return false;
    used_.insert(entry);
    return true;
  }

  bool streams_;
  std::set<std::string> entries_;
  std::set<std::string> used_;
};

}  // namespace

TopicListeners::TopicListeners(bus::Participant& participant, const RecorderConfig& config,
                               const std::function<std::uint16_t(const TopicFacts&)>& add_channel,
                               Arrivals& arrivals) {
  Choice choice(config);
  for (const RawTopic& topic : RawTopicsOf("recorder", config.robots)) {
    if (!choice.Includes(topic.pattern, topic.name)) continue;
    const bool is_latched =
        topic.qos.durability == bus::Durability::kTransientLocal && topic.qos.depth == 1;
    const std::uint16_t channel =
        add_channel({topic.name, topic.type, OfferedQosText(topic.qos), is_latched});
    const bool thins = !config.full_rate && Contains(bus::kMotionPatterns, topic.pattern);
    readers_.push_back(
        topic.listen(participant, thins ? Rate::kThinned : Rate::kFull,
                     [channel, &arrivals](bag::Bytes data, std::optional<std::uint64_t> stamp,
                                          const bus::Guid& writer) {
                       arrivals.Add(channel, stamp, std::move(data), writer);
                     }));
  }
  choice.CheckAllUsed();
}

TopicListeners::~TopicListeners() = default;

std::uint64_t TopicListeners::malformed() const {
  std::uint64_t sum = 0;
  for (const auto& reader : readers_) sum += reader->malformed();
  return sum;
}

namespace {

using namespace std::chrono_literals;

constexpr auto kPeriod = 100ms;
constexpr auto kChunkAge = 900ms;  // with the period: on disk within a second
constexpr auto kQuiet = 200ms;
constexpr auto kQuietLimit = 1s;
constexpr std::size_t kWaitingLimit = std::size_t{64} << 20;

bag::Metadata FactsOf(const bus::Participant& participant, const RecorderConfig& config) {
  bag::TextMap values = config.facts;
  const char* commit = std::getenv("CONAV_COMMIT");
  values["conav_version"] = CONAV_VERSION;
  if (commit != nullptr) values["conav_commit"] = commit;
  values["dds"] = participant.vendor();
  values["domain"] = std::to_string(config.bus.domain_id);
  values["robots"] = Join(config.robots, " ");
  values["streams"] = config.streams ? "true" : "false";
  values["excluded"] = Join(config.exclude, " ");
  const std::time_t now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  values["started"] = UtcTime(now, "%Y-%m-%dT%H:%M:%SZ");
  return {bag::kFactsName, values};
}

std::filesystem::path NextFile(const std::filesystem::path& first) {
  const auto files = bag::FilesLike(first);
  return bag::NumberedFile(first, files.empty() ? 1 : files.rbegin()->first + 1);
}

Result<bag::McapWriter> MakeWriter(const bus::Participant& participant,
                                   const RecorderConfig& config,
                                   const std::filesystem::path& file) {
  bag::McapWriter::Options options;
  options.library = std::string("conav ") + CONAV_VERSION;
  bag::Metadata facts = FactsOf(participant, config);
  if (const auto files = bag::FilesLike(config.file); !files.empty()) {
    facts.values[bag::kFollowsFact] = files.rbegin()->second.filename().string();
  }
  return bag::McapWriter::Create(file, options, {facts});
}

std::uint16_t AddChannel(bag::McapWriter& writer, const TopicFacts& topic) {
  const auto schema = bag::ConavSchemas().find(topic.type);
  DEMAND(schema != bag::ConavSchemas().end(), topic.type);
  return writer.AddChannel(
      {0, topic.type, "ros2msg", schema->second},
      {0, 0, topic.name, "cdr", {{"offered_qos_profiles", topic.offered_qos}}});
}

}  // namespace

RecorderService::RecorderService(bus::Participant& participant, const RecorderConfig& config,
                                 const Clock& clock)
    : participant_(participant),
      clock_(clock),
      config_(config),
      file_(NextFile(config.file)),
      arrivals_(kWaitingLimit, [&participant] { participant.Wake(); }),
      failures_logged_(10s),
      diagnostics_(participant, clock) {
  auto writer = MakeWriter(participant, config, file_);
  if (!writer) throw StartupError("recorder.file: " + writer.error().text);
  writer_.emplace(*std::move(writer));
  const auto add_channel = [this](const TopicFacts& topic) {
    topics_.push_back(topic);
    return AddChannel(*writer_, topic);
  };
  listeners_ = std::make_unique<TopicListeners>(participant, config, add_channel, arrivals_);
  RemoveOldest();
  LOG_INFO("recording", "file", file_.string(), "topics", listeners_->topics());
}

void RecorderService::Rotate() {
  if (!listeners_) return;  // it ends
  const auto reaches = [](std::uint64_t bytes, double mib) {
    return mib > 0.0 && static_cast<double>(bytes) >= mib * 1024.0 * 1024.0;
  };
  if (!reaches(writer_->file_size(), config_.max_file_mib) &&
      !reaches(writer_->index_size(), config_.max_index_mib)) {
    return;
  }
  const std::filesystem::path next = NextFile(config_.file);
  auto writer = MakeWriter(participant_, config_, next);
  if (!writer) {
    // This one grows on; the disk may have room later.
    if (failures_logged_.Allow()) LOG_ERROR("no next file", "reason", writer.error().text);
    return;
  }
  Complete();
  lost_in_earlier_ += writer_->lost();
  writer_.emplace(*std::move(writer));
  file_ = next;
  for (const TopicFacts& topic : topics_) AddChannel(*writer_, topic);  // the same numbers
  for (const auto& [channel, newest] : latched_.newest()) {
    for (const Arrival& arrival : newest) Write(arrival, newest_log_time_);
  }
  RemoveOldest();
  LOG_INFO("recording", "file", file_.string());
}

void RecorderService::RemoveOldest() const {
  if (config_.keep_files == 0) return;
  auto files = bag::FilesLike(config_.file);
  while (files.size() > static_cast<std::size_t>(config_.keep_files)) {
    std::error_code error;
    std::filesystem::remove(files.begin()->second, error);
    if (error) {
      LOG_WARNING("recording not removed", "file", files.begin()->second.string(), "reason",
                  error.message());
    }
    files.erase(files.begin());
  }
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
  std::vector<Arrival> arrivals = arrivals_.Take();
  for (Arrival& arrival : arrivals) {
    newest_log_time_ = arrival.log_time;
    Write(arrival, arrival.log_time);
    if (topics_[arrival.channel - 1U].is_latched) latched_.Keep(std::move(arrival));
  }
  Rotate();
  if (writer_->pending() > 0 && clock_.Now() - chunk_since_ >= kChunkAge) {
    const std::uint64_t size = writer_->file_size();
    Note(writer_->Flush(), size);
  }
  diagnostics_.Tick([this] { return Report(); });
  return !arrivals.empty();
}

void RecorderService::Write(const Arrival& arrival, std::uint64_t log_time) {
  if (writer_->pending() == 0) chunk_since_ = clock_.Now();
  const std::uint64_t size = writer_->file_size();
  Note(writer_->Write(arrival.channel, log_time, arrival.publish_time, arrival.data), size);
}

void RecorderService::Note(const Result<void>& written, std::uint64_t size_before) {
  if (written) {
    if (failure_ && writer_->file_size() > size_before) {
      LOG_INFO("recording goes on", "file", file_.string(), "lost", writer_->lost());
      failure_.reset();
    }
    return;
  }
  failure_ = written.error().text;
  if (failures_logged_.Allow()) {
    LOG_ERROR("messages not recorded", "reason", *failure_, "lost", writer_->lost());
  }
}

void RecorderService::Finish() {
  listeners_.reset();
  Step();
  Complete();
}

void RecorderService::Complete() {
  const std::uint64_t dropped = arrivals_.dropped();
  writer_->NoteLost(dropped - std::exchange(noted_dropped_, dropped));
  if (const auto finished = writer_->Finish(); !finished) {
    LOG_ERROR("the recording has no summary", "reason", finished.error().text, "lost",
              writer_->lost());
  }
  LOG_INFO("recorded", "file", file_.string(), "messages", writer_->message_count(), "bytes",
           writer_->file_size(), "lost", lost());
}

Health RecorderService::Report() const {
  Health health;
  health.message = failure_ ? "messages are lost: " + *failure_ : "recording";
  if (lost() > 0) health.level = Health::Level::kWarning;
  if (failure_) health.level = Health::Level::kError;
  health.values = {{"file", file_.string()},
                   {"messages", std::to_string(writer_->message_count() + writer_->pending())},
                   {"bytes", std::to_string(writer_->file_size())},
                   {"lost", std::to_string(lost())},
                   {"malformed", std::to_string(listeners_ ? listeners_->malformed() : 0)}};
  return health;
}

}  // namespace conav::recorder
