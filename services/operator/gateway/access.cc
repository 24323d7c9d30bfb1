#include "operator/gateway/access.h"

#include <fmt/format.h>
#include <openssl/crypto.h>

#include <algorithm>
#include <array>
#include <boost/asio/ip/address.hpp>
#include <utility>

namespace conav::operators {
namespace {

constexpr std::size_t kShortestToken = 16;

bool Equal(std::string_view a, std::string_view b) {
  return a.size() == b.size() && CRYPTO_memcmp(a.data(), b.data(), a.size()) == 0;
}

/// "[::1]:8080" and "host:8080" without their port.
std::string_view WithoutPort(std::string_view host) {
  const auto bracket = host.rfind(']');
  const auto colon = host.rfind(':');
  if (colon == std::string_view::npos) return host;
  if (bracket != std::string_view::npos && colon < bracket) return host;
  return host.substr(0, colon);
}

/// Names of hosts count alike in both cases.
std::string Lower(std::string_view text) {
  std::string lower(text);
  for (char& c : lower) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return lower;
}

std::string_view HostOfOrigin(std::string_view origin) {
  const auto scheme = origin.find("://");
  return scheme == std::string_view::npos ? std::string_view() : origin.substr(scheme + 3);
}

bool IsAddress(std::string_view host) {
  if (host.size() > 2 && host.front() == '[' && host.back() == ']') {
    host = host.substr(1, host.size() - 2);
  }
  boost::system::error_code no_address;
  boost::asio::ip::make_address(std::string(host), no_address);
  return !no_address;
}

bool IsListedHost(const GatewayOptions& options, std::string_view host) {
  if (host.empty()) return false;
  return std::any_of(
      options.origins.begin(), options.origins.end(),
      [&](const std::string& origin) { return WithoutPort(HostOfOrigin(origin)) == host; });
}

/// "https://console.example.org:8443", as browsers write it; "file://" is a program's own page.
bool IsOrigin(std::string_view origin) {
  if (origin == "file://") return true;
  const std::string_view host = HostOfOrigin(origin);
  return (origin.starts_with("http://") || origin.starts_with("https://")) && !host.empty() &&
         host.find_first_of("/?#@ ") == std::string_view::npos && origin == Lower(origin);
}

Result<void> CheckOrigins(const GatewayOptions& options) {
  for (const std::string& origin : options.origins) {
    if (IsOrigin(origin)) continue;
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("{}: '{}' is not like https://host or "
                            "https://host:port, in lower case and without a path",
                            options.origins_key, origin));
  }
  return {};
}

using NamedTokens = std::array<std::pair<const char*, std::string_view>, 3>;

NamedTokens Named(const ConsoleTokens& tokens) {
  return {{{"observer", tokens.observer},
           {"operator", tokens.operator_token},
           {"admin", tokens.admin}}};
}

Result<void> CheckTokens(const ConsoleTokens& tokens) {
  const NamedTokens named = Named(tokens);
  for (std::size_t i = 0; i < named.size(); ++i) {
    const auto& [name, token] = named[i];
    if (!token.empty() && token.size() < kShortestToken) {
      return Fail(ErrorCode::kInvalidArgument,
                  fmt::format("operator.console.tokens.{} has {} characters, fewer than {}", name,
                              token.size(), kShortestToken));
    }
    for (std::size_t k = 0; k < i; ++k) {
      if (token.empty() || token != named[k].second) continue;
      return Fail(
          ErrorCode::kInvalidArgument,
          fmt::format("operator.console.tokens: {} and {} are the same", named[k].first, name));
    }
  }
  return {};
}

}  // namespace

Result<void> CheckAccess(const GatewayOptions& options) {
  boost::system::error_code no_address;
  const auto address = boost::asio::ip::make_address(options.address, no_address);
  if (no_address) {
    return Fail(
        ErrorCode::kInvalidArgument,
        fmt::format("operator.console.address = {} is not a numeric address", options.address));
  }
  if (options.tokens.empty() && !address.is_loopback()) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("operator.console.address = {} can be reached from other machines: set "
                            "operator.console.tokens, or anyone there can command the robots",
                            options.address));
  }
  if (options.tls.certificate.empty() != options.tls.key.empty()) {
    return Fail(ErrorCode::kInvalidArgument,
                "operator.console.tls needs certificate and key, or neither");
  }
  if (auto sound = CheckOrigins(options); !sound) return sound;
  return CheckTokens(options.tokens);
}

std::optional<console::Role> RoleOf(const ConsoleTokens& tokens, std::string_view token) {
  if (tokens.empty()) return console::ROLE_OPERATOR;
  std::optional<console::Role> role;
  const auto try_one = [&](const std::string& ours, console::Role given) {
    if (!ours.empty() && Equal(ours, token)) role = given;
  };
  try_one(tokens.observer, console::ROLE_OBSERVER);
  try_one(tokens.operator_token, console::ROLE_OPERATOR);
  try_one(tokens.admin, console::ROLE_ADMIN);
  return role;
}

std::string_view BearerToken(std::string_view authorization) {
  constexpr std::string_view kScheme = "Bearer ";
  return authorization.starts_with(kScheme) ? authorization.substr(kScheme.size())
                                            : std::string_view();
}

std::string WhyForeign(const GatewayOptions& options, std::string_view given_host,
                       std::string_view origin) {
  const std::string host = Lower(given_host);
  const std::string_view name = WithoutPort(host);
  if (!IsAddress(name) && name != "localhost" && !IsListedHost(options, name)) {
    return fmt::format("host '{}' is not this console's: list its origin in {}", host,
                       options.origins_key);
  }
  if (origin.empty()) return "";
  const std::string_view scheme = options.tls.on() ? "https://" : "http://";
  if (origin.starts_with(scheme) && HostOfOrigin(origin) == host) return "";
  if (std::ranges::find(options.origins, origin) != options.origins.end()) return "";
  return fmt::format("origin '{}' is not this console's: list it in {}", origin,
                     options.origins_key);
}

}  // namespace conav::operators
