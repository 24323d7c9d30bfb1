#include "operator/foxglove/foxglove_topics.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "common/bus/services.h"
#include "common/bus/topics.h"
#include "common/bus/type_support.h"
#include "common/msg/convert.h"
#include "common/runtime/file.h"
#include "common/runtime/text.h"
#include "operator/recording/mcap_file.h"

namespace conav::foxglove {
namespace {

using namespace std::chrono_literals;
using console::ROLE_OBSERVER;
using operators::ConsoleTopics;

constexpr double kCallValidS = 10.0;  // wall time
constexpr auto kAssetLimit = 3s;
constexpr std::size_t kAssetsAtOnce = 16;
/// Of a topic of the system, which several processes publish.
constexpr std::size_t kSystemHistory = 100;

/// A scalar of YAML as JSON: true, 8 and "lo".
nlohmann::json ToJson(const YAML::Node& node) {
  if (node.IsSequence()) {
    auto list = nlohmann::json::array();
    for (const YAML::Node& entry : node) list.push_back(ToJson(entry));
    return list;
  }
  if (!node.IsScalar()) return nullptr;
  const auto value = nlohmann::json::parse(node.Scalar(), nullptr, false);
  return value.is_number() || value.is_boolean() ? value : nlohmann::json(node.Scalar());
}

Catalog::Entry EntryOf(std::uint32_t id, const recorder::RawTopic& topic) {
  const auto schema = bag::ConavSchemas().find(topic.type);
  DEMAND(schema != bag::ConavSchemas().end(), topic.type);
  const bool latched = topic.qos.durability == bus::Durability::kTransientLocal;
  const bool is_of_system = topic.pattern.find("{}") == std::string_view::npos;
  const bool streams =
      std::ranges::find(bus::kStreamPatterns, topic.pattern) != std::end(bus::kStreamPatterns);
  const auto depth = static_cast<std::size_t>(std::max(topic.qos.depth, 1));
  Catalog::Entry entry;
  entry.channel = {id, topic.name, topic.type, schema->second};
  entry.backlog = streams ? Backlog::kNewest : Backlog::kQueue;
  if (latched) entry.history = is_of_system ? std::max(depth, kSystemHistory) : depth;
  return entry;
}

/// The words of "robot -> planner, operator" before or behind the arrow: letters, lower case.
std::set<std::string> Words(std::string_view text) {
  std::set<std::string> words;
  std::string word;
  for (const char c : text) {
    if (c >= 'a' && c <= 'z') {
      word += c;
    } else if (!word.empty()) {
      words.insert(std::exchange(word, ""));
    }
  }
  if (!word.empty()) words.insert(word);
  return words;
}

/// Whether a process, "sim_w1", is meant by one of `words`. Behind a robot is a simulator or a driver.
bool IsMeant(const std::string& process, const std::set<std::string>& words) {
  const std::string kind =
      process.substr(0, process.find_first_not_of("abcdefghijklmnopqrstuvwxyz"));
  if (words.contains("robot") && (kind == "sim" || kind == "driver")) return true;
  return words.contains(kind) || words.contains(kind + "s");
}

operators::OperatorConfig Checked(operators::OperatorConfig config) {
  if (config.task.on()) {
    throw StartupError(
        "operator.foxglove.port: not with a task, whose participant must not see the true maze");
  }
  return config;
}

Result<geometry_msgs::msg::PoseStamped> ReadGoal(const PublishGoal& goal) {
  geometry_msgs::msg::PoseStamped message;
  if (goal.encoding == "cdr") {
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(goal.payload.data());
    const auto& type = bus::TypeSupportOf<geometry_msgs::msg::PoseStamped>();
    if (!type.deserialize({bytes, goal.payload.size()}, &message)) {
      return Fail(ErrorCode::kMalformed, "no PoseStamped in CDR");
    }
  } else {
    const auto pose = PoseFromJson(goal.payload);
    if (!pose) return tl::unexpected<Error>(pose.error());
    message.header().frame_id(pose->frame);
    message.header().stamp().sec(pose->stamp_s);
    message.header().stamp().nanosec(pose->stamp_ns);
    auto& position = message.pose().position();
    position.x(pose->position[0]);
    position.y(pose->position[1]);
    position.z(pose->position[2]);
    auto& orientation = message.pose().orientation();
    orientation.x(pose->orientation[0]);
    orientation.y(pose->orientation[1]);
    orientation.z(pose->orientation[2]);
    orientation.w(pose->orientation[3]);
  }
  if (const auto place = ToDomain(message); !place) return tl::unexpected<Error>(place.error());
  return message;
}

}  // namespace

struct FoxgloveTopics::RobotLink {
  RobotLink(bus::Participant& participant, const std::string& name, const std::string& world)
      : name(name), world(world), goal(participant, bus::kGoalPose, name) {}

  std::string name;
  std::string world;
  bus::Publisher<geometry_msgs::msg::PoseStamped> goal;
};

/// A robot's description on its way from the bus.
struct FoxgloveTopics::PendingAsset {
  struct Slot {
    std::mutex mutex;  // guards bytes
    std::optional<std::vector<std::uint8_t>> bytes;
  };

  std::uint64_t client = 0;
  FetchAsset fetch;
  Clock::TimePoint until;
  std::shared_ptr<Slot> slot = std::make_shared<Slot>();
  std::unique_ptr<bus::Reader> reader;
};

FoxgloveTopics::FoxgloveTopics(bus::Participant& participant,
                               const operators::OperatorConfig& config, const Clock& clock)
    : participant_(participant),
      clock_(clock),
      topics_(recorder::RawTopicsOf("operator", Checked(config).robots)) {
  Catalog catalog;
  catalog.session = UniqueId();
  for (const recorder::RawTopic& topic : topics_) {
    catalog.channels.push_back(
        EntryOf(static_cast<std::uint32_t>(catalog.channels.size() + 1), topic));
  }
  for (const auto& [robot, world] : config.world_of_robot()) {
    robots_.push_back(std::make_unique<RobotLink>(participant, robot, world));
    catalog.goal_topics.insert(bus::kGoalPose.NameFor(robot));
    for (const auto& service : {bus::kStopService, bus::kResumeService}) {
      service_names_.push_back(service.NameFor(robot));
      catalog.services.push_back(
          {static_cast<std::uint32_t>(service_names_.size()), service_names_.back()});
    }
  }
  for (const ConfigParameter& parameter : ParametersOf(config)) {
    catalog.parameters[fmt::format("/{}.{}", participant.node_name(), parameter.name)] =
        ToJson(parameter.value).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  }
  server_ = std::make_unique<FoxgloveServer>(config.foxglove, config.console, std::move(catalog),
                                             [&participant] { participant.Wake(); });
  LOG_INFO("foxglove", "url", url());
  const std::string& url_file = config.foxglove.url_file;
  if (url_file.empty()) return;
  if (const auto written = WriteFile(url_file, url() + "\n"); !written) {
    throw StartupError("operator.foxglove.url_file: " + written.error().text);
  }
}

FoxgloveTopics::~FoxgloveTopics() = default;

std::vector<ConsoleTopics::Asked> FoxgloveTopics::Step(const operators::ControlRegistry& control,
                                                       SimTime now) {
  server_->SetTime(static_cast<std::uint64_t>(std::max(now.ToSeconds(), 0.0) * 1e9));
  FollowSubscriptions();
  std::vector<ConsoleTopics::Asked> asked;
  for (const ClientRequest& request : server_->Take()) {
    if (const auto* goal = std::get_if<PublishGoal>(&request.body)) {
      Publish(request, *goal, control);
    } else if (const auto* call = std::get_if<CallService>(&request.body)) {
      asked.push_back(Read(request, *call, now));
    } else {
      Fetch(request, std::get<FetchAsset>(request.body));
    }
  }
  AnswerAssets();
  return asked;
}

void FoxgloveTopics::FollowSubscriptions() {
  const std::set<std::uint32_t> wanted = server_->wanted();
  for (auto reader = readers_.begin(); reader != readers_.end();) {
    if (wanted.contains(reader->first)) {
      ++reader;
      continue;
    }
    const std::uint32_t channel = reader->first;
    reader = readers_.erase(reader);
    server_->Forget(channel);
  }
  for (const std::uint32_t channel : wanted) {
    if (readers_.contains(channel)) continue;
    readers_[channel] = topics_[channel - 1].listen(
        participant_, recorder::Rate::kFull,
        [this, channel](std::vector<std::uint8_t> data, std::optional<std::uint64_t> stamp,
                        const bus::Guid&) { server_->Put(channel, std::move(data), stamp); });
  }
}

void FoxgloveTopics::Complain(std::uint64_t client, const std::string& message) {
  server_->Send(client, StatusText(StatusLevel::kError, message), true);
}

void FoxgloveTopics::Publish(const ClientRequest& request, const PublishGoal& goal,
                             const operators::ControlRegistry& control) {
  for (const auto& robot : robots_) {
    if (bus::kGoalPose.NameFor(robot->name) != goal.topic) continue;
    const std::string refusal = control.CheckCommand(request.name, robot->name, clock_.Now());
    if (!refusal.empty()) {
      return Complain(request.client, fmt::format("{}: {}", goal.topic, refusal));
    }
    const auto message = ReadGoal(goal);
    if (!message) {
      return Complain(request.client, fmt::format("{}: {}", goal.topic, message.error().text));
    }
    LOG_INFO("goal of a foxglove client", "client", request.name, "robot", robot->name);
    bus::Send(robot->goal, *message);
  }
}

ConsoleTopics::Asked FoxgloveTopics::Read(const ClientRequest& request, const CallService& call,
                                          SimTime now) {
  const RobotLink& robot = *robots_[(call.service - 1) / 2];
  const bool stops = call.service % 2 == 1;
  OperatorRequest asked;
  asked.stamp = now;
  asked.client = request.name;
  asked.request_id = ++last_request_id_;
  asked.world = robot.world;
  if (stops) {
    asked.body = StopRequest{{robot.name}, "by Foxglove"};
  } else {
    asked.body = ResumeRequest{{robot.name}};
  }
  const bool may = stops || request.role != ROLE_OBSERVER;
  return {[this, client = request.client, call](const OperatorReply& reply) {
            server_->Send(client, TriggerResponseBytes(call, reply.accepted, reply.reason), false);
          },
          std::move(asked), WallSeconds() + kCallValidS,
          may ? "" : "an observer may only watch, and stop robots"};
}

void FoxgloveTopics::Fetch(const ClientRequest& request, const FetchAsset& fetch) {
  const auto refuse = [&](const std::string& why) {
    server_->Send(request.client, AssetErrorBytes(fetch.request_id, why), false);
  };
  constexpr std::string_view kBegin = "package://conav/";
  constexpr std::string_view kEnd = ".urdf";
  std::string_view robot = fetch.uri;
  if (!robot.starts_with(kBegin) || !robot.ends_with(kEnd) ||
      robot.size() < kBegin.size() + kEnd.size()) {
    return refuse("only package://conav/ROBOT.urdf is served here");
  }
  robot = robot.substr(kBegin.size(), robot.size() - kBegin.size() - kEnd.size());
  const std::string name = fmt::format("/{}/robot_description", robot);
  const auto topic = std::ranges::find(topics_, name, &recorder::RawTopic::name);
  if (topic == topics_.end()) return refuse(Readable(name) + " is no topic here");
  if (assets_.size() >= kAssetsAtOnce) return refuse("too many assets are asked for at once");
  auto pending = std::make_unique<PendingAsset>();
  pending->client = request.client;
  pending->fetch = fetch;
  pending->until = clock_.Now() + kAssetLimit;
  pending->reader =
      topic->listen(participant_, recorder::Rate::kFull,
                    [this, slot = pending->slot](std::vector<std::uint8_t> data,
                                                 std::optional<std::uint64_t>, const bus::Guid&) {
                      {
                        const std::lock_guard lock(slot->mutex);
                        slot->bytes = std::move(data);
                      }
                      participant_.Wake();
                    });
  assets_.push_back(std::move(pending));
}

void FoxgloveTopics::AnswerAssets() {
  std::erase_if(assets_, [this](const auto& pending) {
    std::optional<std::vector<std::uint8_t>> bytes;
    {
      const std::lock_guard lock(pending->slot->mutex);
      bytes = pending->slot->bytes;
    }
    if (!bytes && clock_.Now() < pending->until) return false;
    const auto text =
        bytes ? TextFromCdr({reinterpret_cast<const char*>(bytes->data()), bytes->size()})
              : Fail(ErrorCode::kTimeout, "nobody publishes this robot's description");
    const std::uint32_t id = pending->fetch.request_id;
    server_->Send(pending->client,
                  text ? AssetBytes(id, *text) : AssetErrorBytes(id, text.error().text), false);
    return true;
  });
}

void FoxgloveTopics::Receive(const std::map<std::string, operators::ServiceStatus>& services) {
  ConnectionGraph graph;
  const std::string own = "/" + participant_.node_name();
  for (const recorder::RawTopic& topic : topics_) {
    const auto arrow = topic.direction.find("->");
    const std::set<std::string> from = Words(topic.direction.substr(0, arrow));
    const std::set<std::string> to = Words(topic.direction.substr(arrow));
    auto& publishers = graph.publishers[topic.name];
    auto& subscribers = graph.subscribers[topic.name];
    for (const auto& [name, service] : services) {
      if (service.silent) continue;
      // "all services" publish; to whom "all" is open, nobody need listen.
      if (from.contains("all") || IsMeant(name, from)) publishers.insert("/" + name);
      if (IsMeant(name, to)) subscribers.insert("/" + name);
    }
  }
  for (const std::string& name : service_names_) graph.providers[name] = {own};
  if (graph == graph_) return;
  graph_ = std::move(graph);
  server_->SetGraph(GraphText(graph_));
}

void FoxgloveTopics::AddTo(Health& health) const {
  const FoxgloveServer::Figures figures = server_->figures();
  const auto add = [&](const char* key, const auto& value) {
    health.values.emplace_back(key, fmt::format("{}", value));
  };
  add("foxglove_clients", figures.clients);
  add("foxglove_topics", readers_.size());
  add("foxglove_sent", figures.sent);
  add("foxglove_skipped", figures.skipped);
  add("foxglove_dropped", figures.dropped);
}

}  // namespace conav::foxglove
