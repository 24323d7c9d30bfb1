#pragma once

#include <filesystem>

#include "common/runtime/text.h"
#include "operator/gateway/access.h"

namespace conav::test {

/// A file with tokens of olga, otto and ada: "observer-observer", "operator-operator" and
/// "admin-admin-admin", which end at `ends_s` (s since 1970).
inline std::filesystem::path TokenFile(const std::filesystem::path& file, double ends_s = 1e10) {
  using operators::AccessToken;
  const auto token = [&](const char* name, console::Role role, const char* text) {
    return AccessToken{name, role, Sha256Hex(text), ends_s};
  };
  const auto written =
      operators::WriteTokens(file, {token("olga", console::ROLE_OBSERVER, "observer-observer"),
                                    token("otto", console::ROLE_OPERATOR, "operator-operator"),
                                    token("ada", console::ROLE_ADMIN, "admin-admin-admin")});
  DEMAND(written.has_value());
  return file;
}

}  // namespace conav::test
