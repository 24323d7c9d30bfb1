#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "common/runtime/clock.h"
#include "common/runtime/config.h"
#include "common/runtime/result.h"
#include "console.pb.h"

namespace conav::operators {

/// Section `operator.console.tokens:` of earlier versions, which is refused.
struct FormerTokens {
  void Visit(ConfigReader& reader) {
    for (const char* role : {"observer", "operator", "admin"}) {
      std::string token;
      reader.Field(role, token);
      if (token.empty()) continue;
      throw StartupError(
          "operator.console.tokens: tokens no longer stand in the configuration: run `conav token "
          "add NAME --role operator --file tokens.json`, and set operator.console.token_file");
    }
  }
};

/// Section `operator.console.tls:`, PEM files. Both empty: plain HTTP.
struct ConsoleTls {
  std::string certificate;  // with its chain
  std::string key;

  bool on() const { return !certificate.empty(); }
  void Visit(ConfigReader& reader) {
    reader.Field("certificate", certificate);
    reader.Field("key", key);
  }
};

/// Section `operator.console:`, the page and its gateway.
struct GatewayOptions {
  /// TCP port of the console; 0 = any free port, -1 = no console.
  int port = -1;
  /// Numeric address to listen on. Beyond this machine only with tokens and TLS.
  std::string address = "127.0.0.1";
  /// File that the console's URL is written to when it listens; empty = none.
  std::string url_file;
  /// Folder of the page; empty = ../share/conav/console next to the program.
  std::string web;
  /// File of named tokens (`conav token`); empty: everyone who can reach the address is an operator.
  std::string token_file;
  ConsoleTls tls;
  /// Tokens and commands may cross the network in clear: it is trusted, or a proxy adds TLS.
  bool insecure = false;
  /// Other origins whose pages may connect, such as "https://console.example.org" of a proxy.
  std::vector<std::string> origins;
  /// What messages call them; no option.
  std::string origins_key = "operator.console.origins";
  /// With more, the oldest that is no page is dropped for a new one.
  int max_connections = 128;
  /// Of these, from one address (IPv6: one network of 64 bits).
  int max_connections_per_address = 96;
  int max_pages = 32;  // of these, with a WebSocket and a token that counts
  /// What one page may send: messages per second on average, and in a burst.
  double message_rate = 50.0;
  int message_burst = 200;
  int max_message_kib = 512;
  /// Pixels of pictures that are kept for pages, newest first.
  double pictures_mib = 64.0;
  std::size_t image_bytes() const {
    return static_cast<std::size_t>(pictures_mib * 1024.0 * 1024.0);
  }
  /// Updates go to a page at most this often.
  double update_rate_hz = 30.0;
  /// A page that does not answer for so long is gone.
  double idle_s = 20.0;

  bool on() const { return port >= 0; }
  void Visit(ConfigReader& reader) {
    reader.Field("port", port, -1, 65535);
    reader.Field("address", address);
    reader.Field("url_file", url_file);
    reader.Field("web", web);
    reader.Field("token_file", token_file);
    FormerTokens former;
    if (reader.reading()) reader.Section("tokens", former);
    reader.Section("tls", tls);
    reader.Field("insecure", insecure);
    reader.Field("origins", origins);
    reader.Field("max_connections", max_connections, 1, 10000);
    reader.Field("max_connections_per_address", max_connections_per_address, 1, 10000);
    reader.Field("max_pages", max_pages, 1, 10000);
    reader.Field("message_rate", message_rate, 1.0, 10000.0);
    reader.Field("message_burst", message_burst, 1, 100000);
    reader.Field("max_message_kib", max_message_kib, 1, 65536);
    reader.Field("pictures_mib", pictures_mib, 0.0, 65536.0);
    reader.Field("update_rate_hz", update_rate_hz, 1.0, 1000.0);
    reader.Field("idle_s", idle_s, 1.0, 3600.0);
  }
};

/// Section `operator.foxglove:`. Address, tokens, TLS and limits are those of `operator.console`.
struct FoxgloveOptions {
  /// TCP port for Foxglove and its like; 0 = any free port, -1 = none.
  int port = -1;
  /// File that the address is written to when it listens; empty = none.
  std::string url_file;
  /// Origins whose pages may connect, such as "https://app.foxglove.dev"; those of the console may
  /// not, unless they are listed here, too.
  std::vector<std::string> origins;
  /// Messages that wait for one client; a slow one misses the oldest beyond.
  double queue_mib = 8.0;

  bool on() const { return port >= 0; }
  void Visit(ConfigReader& reader) {
    reader.Field("port", port, -1, 65535);
    reader.Field("url_file", url_file);
    reader.Field("origins", origins);
    reader.Field("queue_mib", queue_mib, 0.1, 4096.0);
  }
};

}  // namespace conav::operators

/// Who may connect to the console, and as what. Pure functions.
namespace conav::operators {

/// Refuses options that would let strangers in or cannot work: an address that others reach without
/// tokens, or with tokens in clear, a certificate without its key, an origin in a form that no
/// browser sends. Errors: kInvalidArgument names the key.
[[nodiscard]] Result<void> CheckAccess(const GatewayOptions& options);

/// A named token as its file keeps it: not the token itself, which nobody can read back.
struct AccessToken {
  std::string name;
  console::Role role = console::ROLE_OBSERVER;
  std::string sha256;   // of the token, in hexadecimal
  double ends_s = 0.0;  // s since 1970

  bool operator==(const AccessToken&) const = default;
};

/// "observer", "operator" or "admin".
std::string_view NameOf(console::Role role);

/// The file of `conav token`. Errors: those of ReadFile; kMalformed names file and entry.
[[nodiscard]] Result<std::vector<AccessToken>> ReadTokens(const std::filesystem::path& file);
/// Readable for its owner only. Errors: those of WriteFile.
[[nodiscard]] Result<void> WriteTokens(const std::filesystem::path& file,
                                       const std::vector<AccessToken>& tokens);

/// So many per second on average, and so many at once (a token bucket).
class RateLimit {
 public:
  RateLimit(double per_second, int burst, Clock::TimePoint now)
      : per_second_(per_second), burst_(burst), left_(burst), at_(now) {}

  /// False when one more is too much.
  bool Allow(Clock::TimePoint now) {
    Refill(now);
    if (left_ < 1.0) return false;
    left_ -= 1.0;
    return true;
  }
  /// Takes back the newest one that was allowed.
  void GiveBack() { left_ = std::min(static_cast<double>(burst_), left_ + 1.0); }

 private:
  void Refill(Clock::TimePoint now) {
    const double passed = std::chrono::duration<double>(now - at_).count();
    at_ = now;
    left_ = std::min(static_cast<double>(burst_), left_ + passed * per_second_);
  }

  double per_second_;
  int burst_;
  double left_;
  Clock::TimePoint at_;
};

/// Lets visitors in by their tokens, and slows those who guess. What `conav token` changes in the
/// file counts at once, without a restart; while the file cannot be read, what it held last counts.
/// Threads: one.
class AccessControl {
 public:
  struct Admission {
    console::Role role = console::ROLE_OPERATOR;
    std::string name;    // of the token; empty where no token is needed
    std::string sha256;  // of the token
  };
  /// Wrong tokens that an address may send at once, and later per second.
  static constexpr int kWrongAtOnce = 10;
  static constexpr double kWrongPerSecond = 0.2;
  static constexpr std::size_t kAddressesRemembered = 1024;

  /// Without a file everybody is an operator. `wall`: s since 1970. Throws StartupError: a file that
  /// is missing or malformed.
  explicit AccessControl(std::filesystem::path file, std::function<double()> wall = WallSeconds);

  /// Errors: kRefused: no token, an unknown one, one that has ended; kUnavailable: so many wrong
  /// ones came from `address` that it has to wait. Then tokens that it has used before still count.
  [[nodiscard]] Result<Admission> Admit(std::string_view token, const std::string& address,
                                        Clock::TimePoint now);
  /// Whether a visitor may stay: false when the token was revoked or has ended. Looks once a second.
  bool MayStay(const Admission& admission, Clock::TimePoint now);

 private:
  struct Visitor {  // an address
    RateLimit wrong;
    std::set<std::string> used;  // tokens that counted, by SHA-256
    Clock::TimePoint newest;
  };

  void Reload();
  const AccessToken* Find(std::string_view sha256) const;
  Visitor& VisitorAt(const std::string& address, Clock::TimePoint now);

  std::filesystem::path file_;
  std::function<double()> wall_;
  std::vector<AccessToken> tokens_;
  std::vector<std::int64_t> stamp_;  // of the file that was read
  std::map<std::string, Visitor> visitors_;
  std::optional<Clock::TimePoint> looked_at_;
};

/// The token of "Authorization: Bearer ..."; empty without one.
std::string_view BearerToken(std::string_view authorization);

/// Why a request with these headers is refused; empty = it is not. A page of another site must not
/// reach the console through a browser that can: `origin`, where there is one, is that of `host` or
/// listed; and `host` is an address, localhost or the host of a listed origin, so that no foreign
/// name leads here.
std::string WhyForeign(const GatewayOptions& options, std::string_view host,
                       std::string_view origin);

}  // namespace conav::operators
