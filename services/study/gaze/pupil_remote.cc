#include "study/gaze/pupil_remote.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>
#include <zmq.hpp>

#include "common/runtime/clock.h"
#include "common/runtime/text.h"
#include "study/gaze/eye_recording.h"

namespace conav::gaze {
namespace {

using nlohmann::json;
using SteadyTime = std::chrono::steady_clock::time_point;

constexpr std::array kTopics{"pupil.", "gaze.", "fixation", "blink", "surfaces."};
constexpr int kQueueLimit = 20000;  // messages that wait here: more than 10 s of them
constexpr std::size_t kTopicLimit = 256;
constexpr std::int64_t kFrameLimit = std::int64_t{16} << 20;
/// A difference to the last clock beyond its error and this is a clock that was set.
constexpr double kJumpS = 0.005;
/// Drift over less is the error of the probes.
constexpr double kDriftAfterS = 10.0;

double SteadySeconds(SteadyTime time) {
  return std::chrono::duration<double>(time.time_since_epoch()).count();
}

/// UTC and our steady clock at one moment: the closest of a few readings, as a process can be held up
/// between two.
std::pair<double, double> UtcAndSteady() {
  std::pair<double, double> closest;
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 5; ++i) {
    const double before = SteadySeconds(std::chrono::steady_clock::now());
    const double utc = WallSeconds();
    const double after = SteadySeconds(std::chrono::steady_clock::now());
    if (after - before >= least) continue;
    least = after - before;
    closest = {utc, (before + after) / 2.0};
  }
  return closest;
}

std::string Quoted(const std::string& reply) {
  constexpr std::size_t kShown = 80;
  return fmt::format("'{}'", Readable(reply.substr(0, kShown)));
}

std::optional<double> NumberIn(const std::string& text) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool is_number = error == std::errc() && end == text.data() + text.size();
  return is_number && std::isfinite(value) ? std::optional(value) : std::nullopt;
}

zmq::message_t FrameOf(const json& message) {
  const std::vector<std::uint8_t> bytes = json::to_msgpack(message);
  return {bytes.data(), bytes.size()};
}

/// "tcp://HOST:" of "tcp://HOST:50020".
std::string HostOf(const std::string& address) { return address.substr(0, address.rfind(':') + 1); }

}  // namespace

struct PupilRemote::Sockets {
  explicit Sockets(std::string to)
      : address(std::move(to)),
        request(context, zmq::socket_type::req),
        subscriber(context, zmq::socket_type::sub),
        publisher(context, zmq::socket_type::pub) {
    for (auto* socket : {&request, &subscriber, &publisher}) {
      socket->set(zmq::sockopt::linger, 0);
      socket->set(zmq::sockopt::maxmsgsize, kFrameLimit);
    }
    request.set(zmq::sockopt::rcvtimeo, static_cast<int>(kReplyLimit.count()));
    request.set(zmq::sockopt::sndtimeo, static_cast<int>(kReplyLimit.count()));
    subscriber.set(zmq::sockopt::rcvhwm, kQueueLimit);
    publisher.set(zmq::sockopt::linger, static_cast<int>(kReplyLimit.count()));
  }

  std::string address;
  zmq::context_t context;
  zmq::socket_t request;
  zmq::socket_t subscriber;
  zmq::socket_t publisher;
  std::string version;
  int subscribe_port = 0;
  SteadyTime joined{};
  ClockOffset offset;  // of the tracker's clock to our steady one
  std::optional<TrackerClock> first;
  TrackerClock clock;
};

PupilRemote::PupilRemote(std::unique_ptr<Sockets> sockets) : sockets_(std::move(sockets)) {}
PupilRemote::PupilRemote(PupilRemote&&) noexcept = default;
PupilRemote& PupilRemote::operator=(PupilRemote&&) noexcept = default;
PupilRemote::~PupilRemote() = default;

const std::string& PupilRemote::version() const { return sockets_->version; }
const TrackerClock& PupilRemote::clock() const { return sockets_->clock; }

Result<PupilRemote> PupilRemote::Connect(const std::string& address) {
  try {
    auto sockets = std::make_unique<Sockets>(address);
    sockets->request.connect(address);
    PupilRemote remote(std::move(sockets));
    if (auto joined = remote.Join(); !joined) return tl::unexpected(joined.error());
    return remote;
  } catch (const zmq::error_t& error) {
    return Fail(ErrorCode::kUnavailable, fmt::format("{}: {}", address, error.what()));
  }
}

Result<void> PupilRemote::Join() {
  auto version = Ask("v");
  if (!version) return tl::unexpected(version.error());
  sockets_->version = Readable(version->substr(0, 40));
  const auto subscribe_port = AskPort("SUB_PORT");
  if (!subscribe_port) return tl::unexpected(subscribe_port.error());
  const auto publish_port = AskPort("PUB_PORT");
  if (!publish_port) return tl::unexpected(publish_port.error());
  sockets_->subscribe_port = *subscribe_port;
  const std::string host = HostOf(sockets_->address);
  for (const char* topic : kTopics) sockets_->subscriber.set(zmq::sockopt::subscribe, topic);
  sockets_->subscriber.connect(host + std::to_string(*subscribe_port));
  sockets_->publisher.connect(host + std::to_string(*publish_port));
  sockets_->joined = std::chrono::steady_clock::now();
  const json start = {
      {"subject", "start_plugin"}, {"name", "Annotation_Capture"}, {"args", json::object()}};
  sockets_->request.send(zmq::buffer(std::string_view("notify.start_plugin")),
                         zmq::send_flags::sndmore);
  sockets_->request.send(FrameOf(start), zmq::send_flags::none);
  zmq::message_t reply;
  if (!sockets_->request.recv(reply)) {
    return Fail(ErrorCode::kUnavailable, sockets_->address + ": no reply to notify.start_plugin");
  }
  return Probe();
}

Result<std::string> PupilRemote::Ask(const std::string& command) {
  const auto unavailable = [&](const char* reason) {
    return Fail(ErrorCode::kUnavailable,
                fmt::format("{}: {} to '{}'", sockets_->address, reason, command));
  };
  try {
    if (!sockets_->request.send(zmq::buffer(command))) return unavailable("not sent");
    zmq::message_t reply;
    if (!sockets_->request.recv(reply)) return unavailable("no reply");
    if (reply.more()) return unavailable("a reply of several frames");
    return reply.to_string();
  } catch (const zmq::error_t& error) {
    return unavailable(error.what());
  }
}

Result<int> PupilRemote::AskPort(const std::string& command) {
  return Ask(command).and_then([&](const std::string& reply) -> Result<int> {
    const auto port = NumberIn(reply);
    if (port && *port >= 1.0 && *port <= 65535.0) return static_cast<int>(*port);
    return Fail(ErrorCode::kMalformed,
                fmt::format("{}: replied {} to {}", sockets_->address, Quoted(reply), command));
  });
}

Result<void> PupilRemote::Probe() {
  for (int i = 0; i < kProbes; ++i) {
    const double asked = SteadySeconds(std::chrono::steady_clock::now());
    const auto reply = Ask("t");
    const double arrived = SteadySeconds(std::chrono::steady_clock::now());
    if (!reply) return tl::unexpected(reply.error());
    const auto pupil = NumberIn(*reply);
    if (!pupil) {
      return Fail(ErrorCode::kMalformed, fmt::format("{}: replied {} to t, which is no time",
                                                     sockets_->address, Quoted(*reply)));
    }
    sockets_->offset.Add(asked, *pupil, *pupil, arrived);
  }
  const auto best = sockets_->offset.best();
  if (!best) return Fail(ErrorCode::kMalformed, sockets_->address + ": its clock jumps");
  const auto [utc_s, steady_s] = UtcAndSteady();
  TrackerClock now{
      .utc_s = utc_s, .pupil_s = steady_s + best->offset_s, .round_trip_s = best->round_trip_s};
  const TrackerClock& last = sockets_->clock;
  const bool is_set = !sockets_->first || std::abs(last.ToPupil(now.utc_s) - now.pupil_s) >
                                              kJumpS + (last.round_trip_s + now.round_trip_s) / 2.0;
  if (is_set) sockets_->first = now;
  const double elapsed = now.utc_s - sockets_->first->utc_s;
  if (elapsed >= kDriftAfterS) now.drift = (now.pupil_s - sockets_->first->pupil_s) / elapsed - 1.0;
  sockets_->clock = now;
  return {};
}

Result<TrackerClock> PupilRemote::CheckAlive() {
  const auto port = AskPort("SUB_PORT");
  if (!port) return tl::unexpected(port.error());
  if (*port != sockets_->subscribe_port) {
    return Fail(ErrorCode::kUnavailable, sockets_->address + ": Pupil was started again");
  }
  if (auto probed = Probe(); !probed) return tl::unexpected(probed.error());
  return sockets_->clock;
}

std::optional<PupilMessage> PupilRemote::Receive(std::chrono::milliseconds limit) {
  zmq::pollitem_t item{sockets_->subscriber.handle(), 0, ZMQ_POLLIN, 0};
  try {
    if (zmq::poll(&item, 1, limit) == 0) return std::nullopt;
    PupilMessage message;
    zmq::message_t frame;
    for (int part = 0; sockets_->subscriber.recv(frame, zmq::recv_flags::dontwait); ++part) {
      if (part == 0) message.topic = frame.to_string().substr(0, kTopicLimit);
      if (part == 1) {
        const auto* bytes = frame.data<std::uint8_t>();
        message.payload.assign(bytes, bytes + std::min(frame.size(), kMessageLimit + 1));
      }
      if (!frame.more()) return message;
    }
  } catch (const zmq::error_t&) {  // a signal
  }
  return std::nullopt;
}

bool PupilRemote::MayAnnotate() const {
  return std::chrono::steady_clock::now() - sockets_->joined >= kJoinTime;
}

void PupilRemote::Annotate(const std::string& label, double pupil_s,
                           const std::map<std::string, std::string>& keys) {
  json annotation = json::object();
  for (const auto& [key, value] : keys) annotation[Readable(key)] = Readable(value);
  annotation["topic"] = "annotation";
  annotation["label"] = Readable(label);
  annotation["timestamp"] = pupil_s;
  annotation["duration"] = 0.0;
  sockets_->publisher.send(zmq::buffer(std::string_view("annotation")), zmq::send_flags::sndmore);
  sockets_->publisher.send(FrameOf(annotation), zmq::send_flags::none);
}

}  // namespace conav::gaze
