#include "common/service/health_endpoint.h"

#include <arpa/inet.h>
#include <fmt/core.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <optional>

#include "common/runtime/log.h"
#include "common/runtime/result.h"
#include "common/runtime/text.h"

namespace conav {
namespace {

constexpr int kLookMs = 200;
constexpr std::chrono::milliseconds kClientLimit{500};
constexpr std::size_t kMostBytes = 4096;

std::optional<double> NumberFrom(const std::string& text) {
  double number = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(number)) return {};
  return number;
}

int Listen(const std::string& address) {
  const auto fail = [&](const char* what) -> int {
    throw StartupError(fmt::format("--health {}: cannot {}: {}", address, what, strerror(errno)));
  };
  sockaddr_in port{};
  sockaddr_un path{};
  const auto number = NumberFrom(address);
  if (number && (*number < 1.0 || *number > 65535.0 || *number != std::floor(*number))) {
    throw StartupError(fmt::format("--health {}: a port is 1 to 65535", address));
  }
  const int family = number ? AF_INET : AF_UNIX;
  const int listener = socket(family, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (listener < 0) return fail("make a socket");
  int bound = -1;
  if (number) {
    const int yes = 1;
    setsockopt(listener, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    port.sin_family = AF_INET;
    port.sin_port = htons(static_cast<std::uint16_t>(*number));
    port.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    bound = bind(listener, reinterpret_cast<const sockaddr*>(&port), sizeof port);
  } else {
    path.sun_family = AF_UNIX;
    errno = ENAMETOOLONG;
    if (address.size() < sizeof path.sun_path) {
      address.copy(path.sun_path, sizeof path.sun_path - 1);
      unlink(address.c_str());
      bound = bind(listener, reinterpret_cast<const sockaddr*>(&path), sizeof path);
    }
  }
  if (bound != 0 || listen(listener, 8) != 0) {
    const int error = errno;
    close(listener);
    errno = error;
    return fail("listen");
  }
  return listener;
}

std::string Response(int status, std::string_view type, std::string_view body) {
  const char* reason = status == 200 ? "OK" : status == 404 ? "Not Found" : "Service Unavailable";
  return fmt::format(
      "HTTP/1.1 {} {}\r\nContent-Type: {}\r\nContent-Length: {}\r\nConnection: close\r\n\r\n{}",
      status, reason, type, body.size(), body);
}

/// The target of "GET /livez HTTP/1.1"; empty for others.
std::string TargetOf(const std::string& request) {
  if (!request.starts_with("GET ")) return {};
  return request.substr(4, request.find_first_of(" ?\r", 4) - 4);
}

std::string MetricName(std::string key) {
  for (char& c : key) {
    if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
  }
  return "conav_" + key;
}

/// For a label of Prometheus.
std::string Escaped(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '"' || c == '\\') escaped += '\\';
    escaped += c;
  }
  return escaped;
}

}  // namespace

HealthEndpoint::HealthEndpoint(bus::Participant& participant, const Clock& clock,
                               const std::string& address)
    : name_(participant.node_name()),
      clock_(clock),
      address_(address),
      reports_(participant, bus::kDiagnostics),
      listener_(Listen(address)),
      thread_([this] { Run(); }) {
  LOG_INFO("answers probes", "at", address);
}

HealthEndpoint::~HealthEndpoint() {
  stopping_ = true;
  thread_.join();
  close(listener_);
  if (!NumberFrom(address_)) unlink(address_.c_str());
}

void HealthEndpoint::Run() {
  while (!stopping_) {
    pollfd ready{listener_, POLLIN, 0};
    const bool has_client = poll(&ready, 1, kLookMs) > 0;
    TakeReports();
    if (!has_client) continue;
    const int client = accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC);
    if (client < 0) continue;
    Serve(client);
    close(client);
  }
}

void HealthEndpoint::Serve(int client) {
  const auto end = std::chrono::steady_clock::now() + kClientLimit;
  const auto wait = [&](short what) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(
        end - std::chrono::steady_clock::now());
    pollfd ready{client, what, 0};
    return left.count() > 0 && poll(&ready, 1, static_cast<int>(left.count())) > 0;
  };
  std::string request;
  char bytes[1024];
  while (request.find("\r\n\r\n") == std::string::npos && request.size() < kMostBytes) {
    if (!wait(POLLIN)) return;
    const ssize_t count = recv(client, bytes, sizeof bytes, MSG_DONTWAIT);
    if (count <= 0) return;
    request.append(bytes, static_cast<std::size_t>(count));
  }
  std::string answer = Answer(TargetOf(request));
  while (!answer.empty() && wait(POLLOUT)) {
    const ssize_t count = send(client, answer.data(), answer.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
    if (count < 0) return;
    answer.erase(0, static_cast<std::size_t>(count));
  }
}

void HealthEndpoint::TakeReports() {
  constexpr std::size_t kMostProcesses = 256;
  for (auto& array : reports_.Take()) {
    for (auto& status : array.status()) {
      const std::string process = Readable(status.hardware_id());
      if (process.empty() || (heard_.size() >= kMostProcesses && !heard_.contains(process))) {
        continue;
      }
      Heard& heard = heard_[process];
      // Over a link most reports have none: the last ones stay.
      if (!HasValues(status) && !heard.status.values().empty()) {
        status.values(heard.status.values());
      }
      heard = {std::move(status), clock_.Now()};
    }
  }
}

double HealthEndpoint::AgeOf(const Heard& heard) const {
  return std::chrono::duration<double>(clock_.Now() - heard.at).count();
}

std::string HealthEndpoint::LevelOf(const Heard& heard) const {
  constexpr const char* kLevels[] = {"ok", "warning", "error"};
  if (clock_.Now() - heard.at > kSilent) return "silent";
  return kLevels[std::min<int>(heard.status.level(), 2)];
}

std::string HealthEndpoint::Answer(const std::string& path) const {
  const auto own = heard_.find(name_);
  if (path == "/livez") {
    const bool lives = own == heard_.end() || LevelOf(own->second) != "silent";
    return Response(lives ? 200 : 503, "text/plain", lives ? "ok\n" : "silent\n");
  }
  if (path == "/readyz") {
    bool ready = false;
    const std::string json = Readiness(ready);
    return Response(ready ? 200 : 503, "application/json", json);
  }
  if (path == "/metrics") return Response(200, "text/plain; version=0.0.4", Metrics());
  return Response(404, "text/plain", "nothing here\n");
}

std::string HealthEndpoint::Readiness(bool& ready) const {
  nlohmann::ordered_json json{{"ready", false}, {"message", "starting"}};
  auto& processes = json["processes"] = nlohmann::json::object();
  for (const auto& [process, heard] : heard_) {
    const std::string level = LevelOf(heard);
    processes[process] = level;
    if (process != name_) continue;
    ready = level == "ok" || level == "warning";
    json["message"] = level == "silent" ? "silent" : Readable(heard.status.message());
  }
  json["ready"] = ready;
  return json.dump() + "\n";
}

std::string HealthEndpoint::Metrics() const {
  std::string text =
      "# HELP conav_health_level 0 ok, 1 warning, 2 error, as last reported\n"
      "# TYPE conav_health_level gauge\n";
  for (const auto& [process, heard] : heard_) {
    text += fmt::format("conav_health_level{{process=\"{}\"}} {}\n", Escaped(process),
                        static_cast<int>(heard.status.level()));
  }
  text += "# TYPE conav_report_age_seconds gauge\n";
  for (const auto& [process, heard] : heard_) {
    text += fmt::format("conav_report_age_seconds{{process=\"{}\"}} {:.3f}\n", Escaped(process),
                        AgeOf(heard));
  }
  const auto own = heard_.find(name_);
  if (own == heard_.end()) return text;
  for (const auto& pair : own->second.status.values()) {
    const auto number = NumberFrom(pair.value());
    if (!number) continue;
    const std::string name = MetricName(pair.key());
    text += fmt::format("# TYPE {} gauge\n{} {}\n", name, name, *number);
  }
  return text;
}

}  // namespace conav
