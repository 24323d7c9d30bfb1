#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "operator/gateway/access.h"
#include "operator/gateway/snapshot_store.h"

namespace conav::operators {

/// The files of the page, read into memory once; `x.js.gz` next to `x.js` is its compressed form.
class WebFiles {
 public:
  struct File {
    std::string type;  // Content-Type
    std::shared_ptr<const std::string> plain;
    std::shared_ptr<const std::string> gzip;  // may be null
    std::string etag;
    std::string gzip_etag;
    bool immutable = false;  // its name changes with its content
  };

  /// Throws StartupError: the folder holds no index.html, a file cannot be read.
  explicit WebFiles(const std::filesystem::path& folder);

  /// `path` as in the URL, "/" is the page itself. Null when there is no such file.
  const File* Find(std::string_view path) const;

 private:
  void Add(const std::filesystem::path& folder, const std::filesystem::path& path);

  std::map<std::string, File, std::less<>> files_;  // by URL path
};

/// The default folder of the page: share/conav/console next to the program's folder.
std::filesystem::path DefaultWebFolder();

/// The parts of an HTTP request that the gateway uses.
struct HttpRequest {
  std::string method;
  std::string target;
  std::string host;
  std::string origin;
  std::string authorization;
  std::string accept_encoding;
  std::string if_none_match;
  std::string protocols;  // Sec-WebSocket-Protocol
  std::string address;    // of the client
};

/// Bytes to send, which others may have, too: a file of the page, a stored picture.
struct HttpBody {
  HttpBody() = default;
  template <class Bytes>
  explicit HttpBody(std::shared_ptr<const Bytes> shared)
      : bytes(reinterpret_cast<const char*>(shared->data()), shared->size()),
        owner(std::move(shared)) {}

  std::string_view bytes;
  std::shared_ptr<const void> owner;  // keeps them
};

struct HttpResponse {
  unsigned status = 200;
  std::string type = "text/plain; charset=utf-8";
  std::vector<std::pair<std::string, std::string>> headers;
  HttpBody body;
};

/// Whether the service works, for /livez and /readyz.
struct Readiness {
  bool ready = false;
  std::string json = "{}";          // per dependency
  std::chrono::nanoseconds age{0};  // since the service said so
};

/// Answers everything but the WebSocket:
///   /, /assets/...                the page
///   /pictures/<robot>/<n>.jpg     pixels; with a token, where tokens are set
///   /livez                        200 or, when the service has said nothing for 30 s, 503
///   /readyz                       200 or 503, and why, as JSON; 503 also when that is 5 s old
///   /metrics                      Prometheus text; with a token, where tokens are set
/// Threads: one.
class HttpRoutes {
 public:
  struct Sources {
    const SnapshotStore& snapshots;
    AccessControl& access;
    std::function<Readiness()> readiness;
    std::function<std::string()> metrics;
  };

  HttpRoutes(const GatewayOptions& options, WebFiles files, Sources sources);

  HttpResponse Answer(const HttpRequest& request) const;
  /// The response to a request that cannot be parsed.
  static HttpResponse Refuse(unsigned status, const std::string& why);

 private:
  HttpResponse Route(const HttpRequest& request) const;
  static HttpResponse AnswerReadiness(Readiness readiness);
  HttpResponse AnswerFile(const WebFiles::File& file, const HttpRequest& request) const;
  HttpResponse AnswerSnapshot(std::string_view rest) const;

  GatewayOptions options_;
  WebFiles files_;
  Sources sources_;
};

}  // namespace conav::operators
