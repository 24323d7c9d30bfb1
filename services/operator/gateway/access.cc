#include "operator/gateway/access.h"

#include <fmt/core.h>
#include <openssl/crypto.h>
#include <sys/stat.h>

#include <array>
#include <boost/asio/ip/address.hpp>
#include <nlohmann/json.hpp>
#include <utility>

#include "common/runtime/file.h"
#include "common/runtime/log.h"
#include "common/runtime/text.h"

namespace conav::operators {
namespace {

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

}  // namespace

Result<void> CheckAccess(const GatewayOptions& options) {
  boost::system::error_code no_address;
  const auto address = boost::asio::ip::make_address(options.address, no_address);
  if (no_address) {
    return Fail(
        ErrorCode::kInvalidArgument,
        fmt::format("operator.console.address = {} is not a numeric address", options.address));
  }
  if (options.token_file.empty() && !address.is_loopback()) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("operator.console.address = {} can be reached from other machines: set "
                            "operator.console.token_file, or anyone there can command the robots",
                            options.address));
  }
  if (!options.tls.on() && !options.insecure && !address.is_loopback()) {
    return Fail(
        ErrorCode::kInvalidArgument,
        fmt::format("operator.console.address = {} can be reached from other machines: set "
                    "operator.console.tls, or tokens cross the network in clear (--insecure "
                    "where the network is trusted)",
                    options.address));
  }
  if (options.tls.certificate.empty() != options.tls.key.empty()) {
    return Fail(ErrorCode::kInvalidArgument,
                "operator.console.tls needs certificate and key, or neither");
  }
  return CheckOrigins(options);
}

namespace {

constexpr std::array<std::pair<console::Role, std::string_view>, 3> kRoles{
    {{console::ROLE_OBSERVER, "observer"},
     {console::ROLE_OPERATOR, "operator"},
     {console::ROLE_ADMIN, "admin"}}};
constexpr std::size_t kSha256Digits = 64;
constexpr std::chrono::seconds kLookAgain{1};

std::optional<AccessToken> TokenFromJson(const nlohmann::json& entry) {
  AccessToken token;
  try {
    entry.at("name").get_to(token.name);
    entry.at("sha256").get_to(token.sha256);
    entry.at("ends_s").get_to(token.ends_s);
    const auto role = std::ranges::find(kRoles, entry.at("role").get<std::string>(),
                                        &std::pair<console::Role, std::string_view>::second);
    if (role == kRoles.end() || token.sha256.size() != kSha256Digits) return std::nullopt;
    token.role = role->first;
  } catch (const nlohmann::json::exception&) {
    return std::nullopt;
  }
  return token;
}

/// Changes with the file.
std::vector<std::int64_t> StampOf(const std::filesystem::path& file) {
  struct stat status {};
  if (::stat(file.c_str(), &status) != 0) return {};
  return {static_cast<std::int64_t>(status.st_ino), status.st_size, status.st_mtim.tv_sec,
          status.st_mtim.tv_nsec};
}

}  // namespace

std::string_view NameOf(console::Role role) {
  return std::ranges::find(kRoles, role, &std::pair<console::Role, std::string_view>::first)
      ->second;
}

Result<std::vector<AccessToken>> ReadTokens(const std::filesystem::path& file) {
  const auto text = ReadFile(file);
  if (!text) return tl::unexpected(text.error());
  const auto document = nlohmann::json::parse(*text, nullptr, false);
  const auto list = document.is_object() ? document.value("tokens", nlohmann::json()) : document;
  if (!list.is_array()) {
    return Fail(ErrorCode::kMalformed, fmt::format("{}: is no file of tokens", file.string()));
  }
  std::vector<AccessToken> tokens;
  for (const auto& entry : list) {
    auto token = TokenFromJson(entry);
    if (!token) {
      return Fail(ErrorCode::kMalformed,
                  fmt::format("{}: token {} is malformed", file.string(), tokens.size() + 1));
    }
    tokens.push_back(*std::move(token));
  }
  return tokens;
}

Result<void> WriteTokens(const std::filesystem::path& file,
                         const std::vector<AccessToken>& tokens) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const AccessToken& token : tokens) {
    list.push_back({{"name", token.name},
                    {"role", NameOf(token.role)},
                    {"ends_s", token.ends_s},
                    {"sha256", token.sha256}});
  }
  return WriteSecretFile(file, JsonText({{"tokens", list}}));
}

AccessControl::AccessControl(std::filesystem::path file, std::function<double()> wall)
    : file_(std::move(file)), wall_(std::move(wall)) {
  if (file_.empty()) return;
  auto tokens = ReadTokens(file_);
  if (!tokens) {
    throw StartupError(
        fmt::format("operator.console.token_file: {}; `conav token add NAME --role operator --file "
                    "{}` adds one",
                    tokens.error().text, file_.string()));
  }
  tokens_ = *std::move(tokens);
  stamp_ = StampOf(file_);
}

void AccessControl::Reload() {
  auto stamp = StampOf(file_);
  if (stamp == stamp_) return;
  stamp_ = std::move(stamp);
  if (auto tokens = ReadTokens(file_)) {
    tokens_ = *std::move(tokens);
  } else {
    LOG_WARNING("tokens not read again, those from before count", "reason", tokens.error().text);
  }
}

const AccessToken* AccessControl::Find(std::string_view sha256) const {
  const auto found = std::ranges::find_if(
      tokens_, [&](const AccessToken& token) { return Equal(token.sha256, sha256); });
  return found == tokens_.end() || wall_() >= found->ends_s ? nullptr : &*found;
}

AccessControl::Visitor& AccessControl::VisitorAt(const std::string& address, Clock::TimePoint now) {
  if (visitors_.size() >= kAddressesRemembered && !visitors_.contains(address)) {
    visitors_.erase(std::ranges::min_element(
        visitors_, {}, [](const auto& entry) { return entry.second.newest; }));
  }
  Visitor& visitor =
      visitors_.try_emplace(address, Visitor{{kWrongPerSecond, kWrongAtOnce, now}, {}, now})
          .first->second;
  visitor.newest = now;
  return visitor;
}

Result<AccessControl::Admission> AccessControl::Admit(std::string_view token,
                                                      const std::string& address,
                                                      Clock::TimePoint now) {
  if (file_.empty()) return Admission{};
  if (token.empty()) return Fail(ErrorCode::kRefused, "a token is required");
  Reload();
  Visitor& visitor = VisitorAt(address, now);
  const std::string sha256 = Sha256Hex(token);
  if (!visitor.used.contains(sha256) && !visitor.wrong.Allow(now)) {
    return Fail(ErrorCode::kUnavailable,
                fmt::format("too many wrong tokens came from {}: wait {:.0f} s", address,
                            1.0 / kWrongPerSecond));
  }
  const AccessToken* found = Find(sha256);
  if (found == nullptr) return Fail(ErrorCode::kRefused, "the token is not known, or has ended");
  if (visitor.used.insert(sha256).second) visitor.wrong.GiveBack();
  return Admission{found->role, found->name, found->sha256};
}

bool AccessControl::MayStay(const Admission& admission, Clock::TimePoint now) {
  if (file_.empty()) return true;
  if (!looked_at_ || now - *looked_at_ >= kLookAgain) {
    looked_at_ = now;
    Reload();
  }
  return Find(admission.sha256) != nullptr;
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
