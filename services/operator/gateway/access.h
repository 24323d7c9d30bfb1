#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/runtime/config.h"
#include "common/runtime/result.h"
#include "console.pb.h"

namespace conav::operators {

/// Section `operator.console.tokens:`. All empty: everyone who can reach the address is an
/// operator.
struct ConsoleTokens {
  std::string observer;
  std::string operator_token;
  std::string admin;

  bool empty() const { return observer.empty() && operator_token.empty() && admin.empty(); }
  void Visit(ConfigReader& reader) {
    reader.Secret("observer", observer);
    reader.Secret("operator", operator_token);
    reader.Secret("admin", admin);
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
  /// Numeric address to listen on. Beyond this machine only with tokens.
  std::string address = "127.0.0.1";
  /// File that the console's URL is written to when it listens; empty = none.
  std::string url_file;
  /// Folder of the page; empty = ../share/conav/console next to the program.
  std::string web;
  ConsoleTokens tokens;
  ConsoleTls tls;
  /// Other origins whose pages may connect, such as "https://console.example.org" of a proxy.
  std::vector<std::string> origins;
  /// What messages call them; no option.
  std::string origins_key = "operator.console.origins";
  int max_connections = 128;
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
    reader.Section("tokens", tokens);
    reader.Section("tls", tls);
    reader.Field("origins", origins);
    reader.Field("max_connections", max_connections, 1, 10000);
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
/// tokens, a token that is short or used twice, a certificate without its key, an origin in a form
/// that no browser sends. Errors: kInvalidArgument names the key.
[[nodiscard]] Result<void> CheckAccess(const GatewayOptions& options);

/// The role that `token` gives; nothing when it is none of ours. Takes equally long for wrong
/// tokens of one length.
std::optional<console::Role> RoleOf(const ConsoleTokens& tokens, std::string_view token);

/// The token of "Authorization: Bearer ..."; empty without one.
std::string_view BearerToken(std::string_view authorization);

/// Why a request with these headers is refused; empty = it is not. A page of another site must not
/// reach the console through a browser that can: `origin`, where there is one, is that of `host` or
/// listed; and `host` is an address, localhost or the host of a listed origin, so that no foreign
/// name leads here.
std::string WhyForeign(const GatewayOptions& options, std::string_view host,
                       std::string_view origin);

}  // namespace conav::operators
