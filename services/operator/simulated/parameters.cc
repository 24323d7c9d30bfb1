#include "operator/simulated/synthetic_operator.h"

namespace conav::operators {

void PictureReaderParameters::Visit(ConfigReader& reader) {
  reader.Field("edit_probability", edit_probability, 0.0, 1.0);
  reader.Field("decay_cells", decay_cells, 0.01, 1e6);
  reader.Field("path_removal_probability", path_removal_probability, 0.0, 1.0);
  reader.Field("far_centre_probability", far_centre_probability, 0.0, 1.0);
  reader.Field("far_cells", far_cells, 0.0, 1e6);
  reader.Field("centre_deg", centre_deg, 0.0, 180.0);
  reader.Field("lateral_factor", lateral_factor, 0.0, 1.0);
  reader.Field("lateral_deg", lateral_deg, 0.0, 180.0);
  reader.Field("misplacement_probability", misplacement_probability, 0.0, 1.0);
  reader.Field("near_cells", near_cells, 0.0, 1e6);
  reader.Field("lapse_probability", lapse_probability, 0.0, 1.0);
  reader.Field("guess_probability", guess_probability, 0.0, 1.0);
  reader.Field("edit_limit", edit_limit, 0, 1000);
}

void SyntheticOperatorParameters::Visit(ConfigReader& visitor) {
  visitor.Section("reader", reader);
  visitor.Section("planner", planner);
  visitor.Field("glance_rate", glance_rate, 0.0, 1.0);
  visitor.Field("thinking_time_s", thinking_time_s, 0.0, 3600.0);
  visitor.Field("guidance_valid_s", guidance_valid_s, 0.1, 1e6);
  visitor.Field("retry_pause_s", retry_pause_s, 0.0, 60.0);
  visitor.Field("attempts", attempts, 1, 100000);
  visitor.Field("patience_s", patience_s, 0.0, 3600.0);
}

}  // namespace conav::operators
