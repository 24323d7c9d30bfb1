#pragma once

#include "common/msg/supervision.h"
#include "common/runtime/result.h"
#include "console.pb.h"
#include "operator/gateway/page_feed.h"

namespace conav::operators {

/// Converts a page's request into the OperatorRequest that a client on the bus sends, and checks it
/// as such (Checked() in common/msg/supervision.h).
/// Errors: kMalformed names the field, the value and the limit.
[[nodiscard]] Result<OperatorRequest> ToOperatorRequest(const console::Request& request,
                                                        const std::string& client, SimTime now);

/// Why a page with this role and connection may not ask that now; empty = it may. `wall_s`: s
/// since 1970, as in `valid_until`. `drive_limit_s`: the longest round trip for driving.
std::string CheckNow(const PageIdentity& who, const PageAsked& asked, double wall_s,
                     double drive_limit_s);

}  // namespace conav::operators
