#include "operator/gateway/http_routes.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <optional>

#include "common/runtime/file.h"
#include "common/runtime/result.h"
#include "common/runtime/text.h"

namespace conav::operators {
namespace {

constexpr std::array<std::pair<std::string_view, const char*>, 9> kTypes{{
    {".html", "text/html; charset=utf-8"},
    {".js", "text/javascript; charset=utf-8"},
    {".css", "text/css; charset=utf-8"},
    {".svg", "image/svg+xml"},
    {".png", "image/png"},
    {".ico", "image/x-icon"},
    {".json", "application/json"},
    {".webmanifest", "application/manifest+json"},
    {".woff2", "font/woff2"},
}};

const char* TypeOf(const std::filesystem::path& file) {
  const std::string extension = file.extension().string();
  for (const auto& [ending, type] : kTypes) {
    if (extension == ending) return type;
  }
  return "application/octet-stream";
}

std::shared_ptr<const std::string> Read(const std::filesystem::path& file) {
  auto text = ReadFile(file);
  if (!text) throw StartupError(fmt::format("console page: {}", text.error().text));
  return std::make_shared<const std::string>(*std::move(text));
}

/// Without compressed ones. None where there is no such folder.
std::vector<std::filesystem::path> FilesBelow(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  if (!std::filesystem::exists(folder)) return files;
  try {
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
      if (entry.is_regular_file() && entry.path().extension() != ".gz") {
        files.push_back(entry.path());
      }
    }
  } catch (const std::filesystem::filesystem_error& error) {
    throw StartupError(fmt::format("console page: {}", error.what()));
  }
  return files;
}

}  // namespace

WebFiles::WebFiles(const std::filesystem::path& folder) {
  for (const auto& path : FilesBelow(folder)) Add(folder, path);
  if (!files_.contains("/index.html")) {
    throw StartupError(fmt::format("console page: {} has no index.html", folder.string()));
  }
  files_["/"] = files_["/index.html"];
}

void WebFiles::Add(const std::filesystem::path& folder, const std::filesystem::path& path) {
  File file;
  file.type = TypeOf(path);
  file.plain = Read(path);
  const std::filesystem::path compressed = path.string() + ".gz";
  if (std::filesystem::exists(compressed)) file.gzip = Read(compressed);
  const std::string digits = Sha256Hex(*file.plain).substr(0, 16);
  file.etag = fmt::format("\"{}\"", digits);
  file.gzip_etag = fmt::format("\"{}-gz\"", digits);
  const std::string url = fmt::format("/{}", path.lexically_relative(folder).generic_string());
  file.immutable = url.starts_with("/assets/");
  files_[url] = std::move(file);
}

const WebFiles::File* WebFiles::Find(std::string_view path) const {
  const auto found = files_.find(path);
  return found == files_.end() ? nullptr : &found->second;
}

std::filesystem::path DefaultWebFolder() {
  std::error_code unknown;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", unknown);
  return program.parent_path().parent_path() / "share/conav/console";
}

namespace {

constexpr std::string_view kSnapshots = "/pictures/";
constexpr std::string_view kJpeg = ".jpg";
constexpr std::chrono::seconds kReadinessCounts{5};
constexpr std::chrono::seconds kStuckAfter{30};

HttpResponse Text(unsigned status, std::string text) {
  HttpResponse response;
  response.status = status;
  response.headers = {{"Cache-Control", "no-store"}};
  response.body = HttpBody(std::make_shared<const std::string>(std::move(text)));
  return response;
}

/// Restricts what browsers allow this page, and pages that embed it.
void AddSecurityHeaders(HttpResponse& response) {
  response.headers.emplace_back(
      "Content-Security-Policy",
      "default-src 'self'; img-src 'self' blob: data:; object-src 'none'; base-uri 'none'; "
      "form-action 'none'; frame-ancestors 'none'");
  response.headers.emplace_back("X-Content-Type-Options", "nosniff");
  response.headers.emplace_back("Referrer-Policy", "no-referrer");
  response.headers.emplace_back("Cross-Origin-Resource-Policy", "same-origin");
}

/// The first of a list that is separated by `separator`, without blanks around it; it leaves
/// `list`.
std::string_view TakeFirst(std::string_view& list, char separator) {
  const auto end = std::min(list.find(separator), list.size());
  std::string_view one = list.substr(0, end);
  list.remove_prefix(std::min(end + 1, list.size()));
  one.remove_prefix(std::min(one.find_first_not_of(" \t"), one.size()));
  return one.substr(0, one.find_last_not_of(" \t") + 1);
}

/// Whether `accept_encoding` (RFC 9110, 12.5.3) takes gzip, by name and not with quality 0.
bool TakesGzip(std::string_view accept_encoding) {
  while (!accept_encoding.empty()) {
    std::string_view one = TakeFirst(accept_encoding, ',');
    if (TakeFirst(one, ';') != "gzip") continue;
    return one.find_first_of("123456789") != std::string_view::npos || one.empty();
  }
  return false;
}

/// Whether a browser that has one of `if_none_match` has `etag` (RFC 9110, 13.1.2: the weak
/// comparison, because proxies that compress make it weak).
bool IsAmong(std::string_view if_none_match, std::string_view etag) {
  if (if_none_match == "*") return true;
  while (!if_none_match.empty()) {
    std::string_view one = TakeFirst(if_none_match, ',');
    if (one.starts_with("W/")) one.remove_prefix(2);
    if (one == etag) return true;
  }
  return false;
}

std::optional<std::uint64_t> NumberOf(std::string_view text) {
  std::uint64_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

HttpResponse RefuseVisitor(const Error& error) {
  const bool must_wait = error.code == ErrorCode::kUnavailable;
  HttpResponse refused = Text(must_wait ? 429 : 401, error.text + "\n");
  refused.headers.emplace_back("WWW-Authenticate", "Bearer");
  return refused;
}

}  // namespace

HttpRoutes::HttpRoutes(const GatewayOptions& options, WebFiles files, Sources sources)
    : options_(options), files_(std::move(files)), sources_(std::move(sources)) {}

HttpResponse HttpRoutes::Answer(const HttpRequest& request) const {
  HttpResponse response = Route(request);
  AddSecurityHeaders(response);
  return response;
}

HttpResponse HttpRoutes::Refuse(unsigned status, const std::string& why) {
  HttpResponse response = Text(status, why + "\n");
  AddSecurityHeaders(response);
  return response;
}

HttpResponse HttpRoutes::Route(const HttpRequest& request) const {
  if (request.method != "GET" && request.method != "HEAD") {
    HttpResponse refused = Text(405, "only GET and HEAD\n");
    refused.headers.emplace_back("Allow", "GET, HEAD");
    return refused;
  }
  if (const auto why = WhyForeign(options_, request.host, request.origin); !why.empty()) {
    return Text(403, why + "\n");
  }
  const std::string_view path =
      std::string_view(request.target).substr(0, request.target.find_first_of("?#"));
  if (const auto* file = files_.Find(path)) return AnswerFile(*file, request);
  if (path == "/livez") {
    const bool is_stuck = sources_.readiness().age > kStuckAfter;
    return is_stuck ? Text(503, "the service is stuck\n") : Text(200, "ok\n");
  }
  if (path == "/readyz") return AnswerReadiness(sources_.readiness());
  const bool is_snapshot = path.starts_with(kSnapshots);
  if (path != "/metrics" && !is_snapshot) return Text(404, "nothing here\n");
  const auto admitted = sources_.access.Admit(BearerToken(request.authorization), request.address,
                                              Clock::TimePoint::clock::now());
  if (!admitted) return RefuseVisitor(admitted.error());
  if (is_snapshot) return AnswerSnapshot(path.substr(kSnapshots.size()));
  HttpResponse metrics = Text(200, sources_.metrics());
  metrics.type = "text/plain; version=0.0.4; charset=utf-8";
  return metrics;
}

HttpResponse HttpRoutes::AnswerReadiness(Readiness readiness) {
  const bool is_old = readiness.age > kReadinessCounts;
  if (is_old) readiness.json = "{\"ready\":false,\"message\":\"the service does not answer\"}\n";
  HttpResponse response = Text(readiness.ready && !is_old ? 200 : 503, std::move(readiness.json));
  response.type = "application/json";
  return response;
}

HttpResponse HttpRoutes::AnswerFile(const WebFiles::File& file, const HttpRequest& request) const {
  const bool sends_gzip = file.gzip && TakesGzip(request.accept_encoding);
  const std::string& etag = sends_gzip ? file.gzip_etag : file.etag;
  HttpResponse response;
  response.type = file.type;
  response.headers = {
      {"ETag", etag},
      {"Vary", "Accept-Encoding"},
      {"Cache-Control", file.immutable ? "public, max-age=31536000, immutable" : "no-cache"}};
  if (IsAmong(request.if_none_match, etag)) {
    response.status = 304;
    return response;
  }
  response.body = HttpBody(sends_gzip ? file.gzip : file.plain);
  if (sends_gzip) response.headers.emplace_back("Content-Encoding", "gzip");
  return response;
}

HttpResponse HttpRoutes::AnswerSnapshot(std::string_view rest) const {
  const auto slash = rest.find('/');
  const auto number = slash != std::string_view::npos && rest.ends_with(kJpeg)
                          ? NumberOf(rest.substr(slash + 1, rest.size() - slash - 1 - kJpeg.size()))
                          : std::nullopt;
  if (!number) return Text(404, "/pictures/<robot>/<number>.jpg\n");
  auto pixels = sources_.snapshots.Find(std::string(rest.substr(0, slash)), *number);
  if (!pixels) return Text(404, "this picture is no longer stored\n");
  HttpResponse response;
  response.body = HttpBody(std::move(pixels));
  response.type = "image/jpeg";
  response.headers = {{"Cache-Control", "private, no-cache"}};
  return response;
}

}  // namespace conav::operators
