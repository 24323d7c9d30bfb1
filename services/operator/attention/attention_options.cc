#include "operator/attention/attention_options.h"

#include "common/runtime/config.h"
#include "operator/attention/attention_order.h"

namespace conav::operators {

double InteractionPriors::MedianOf(AttentionReason reason) const {
  switch (reason) {
    case AttentionReason::kPicture:
      return picture_s;
    case AttentionReason::kBlocked:
      return blocked_s;
    case AttentionReason::kNoGuidance:
    case AttentionReason::kFirstPath:
      return path_s;
    default:
      return notice_s;
  }
}

void InteractionPriors::Visit(ConfigReader& reader) {
  reader.Field("picture_s", picture_s, 0.01, 3600.0);
  reader.Field("blocked_s", blocked_s, 0.01, 3600.0);
  reader.Field("path_s", path_s, 0.01, 3600.0);
  reader.Field("notice_s", notice_s, 0.01, 3600.0);
  reader.Field("log_sd", log_sd, 0.0, 5.0);
  reader.Field("weight", weight, 0.01, 1000.0);
}

void AttentionOptions::Visit(ConfigReader& reader) {
  reader.Choice("order", order, AttentionOrders());
  reader.Field("hysteresis_factor", hysteresis_factor, 1.0, 1000.0);
  reader.Field("dwell_s", dwell_s, 0.0, 3600.0);
  reader.Field("default_deadline_s", default_deadline_s, 0.0, 1e6);
  reader.Field("default_value_lost_per_s", default_value_lost_per_s, 0.0, 1e6);
  reader.Field("notice_s", notice_s, 0.0, 3600.0);
  reader.Field("window_s", window_s, 1.0, 1e6);
  reader.Field("linger_s", linger_s, 0.0, 3600.0);
  reader.Section("priors", priors);
}

}  // namespace conav::operators
