#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/runtime/result.h"
#include "console.pb.h"
#include "operator/gateway/gateway_options.h"

/// Who may connect to the console, and as what. Pure functions.
namespace conav::operators {

/// Refuses options that would let strangers in or cannot work: an address that others reach without
/// tokens, a token that is short or used twice, a certificate without its key, an origin that no
/// browser would send so.
/// Errors: kInvalidArgument names the key.
[[nodiscard]] Result<void> CheckAccess(const GatewayOptions& options);

/// The role that `token` gives; nothing when it is none of ours. Takes equally long for wrong tokens
/// of one length.
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
