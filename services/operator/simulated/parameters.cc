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

void InteractionTimeParameters::Visit(ConfigReader& reader) {
  reader.Field("picture_s", picture_s, 0.0, 3600.0);
  reader.Field("blocked_s", blocked_s, 0.0, 3600.0);
  reader.Field("path_s", path_s, 0.0, 3600.0);
  reader.Field("log_sd", log_sd, 0.0, 5.0);
}

void SyntheticOperatorParameters::Visit(ConfigReader& visitor) {
  if (visitor.reading()) {
    std::string kind = "careful";
    visitor.Choice("kind", kind, OperatorKinds());
    *this = ParametersOfKind(kind);
  }
  visitor.Field("silent", silent);
  visitor.Section("reader", reader);
  visitor.Section("planner", planner);
  visitor.Section("steering", steering);
  visitor.Field("glance_rate", glance_rate, 0.0, 1.0);
  visitor.Field("thinking_time_s", thinking_time_s, 0.0, 3600.0);
  visitor.Field("guidance_valid_s", guidance_valid_s, 0.1, 1e6);
  visitor.Field("retry_pause_s", retry_pause_s, 0.0, 60.0);
  visitor.Field("attempts", attempts, 1, 100000);
  visitor.Field("patience_s", patience_s, 0.0, 3600.0);
  visitor.Choice("order", order, {"heard", "queue"});
  visitor.Section("interaction", interaction);
}

const std::vector<std::string>& OperatorKinds() {
  static const std::vector<std::string> kinds{"careful", "hasty", "wrong", "silent"};
  return kinds;
}

SyntheticOperatorParameters ParametersOfKind(const std::string& kind) {
  SyntheticOperatorParameters person;
  if (kind == "hasty") {
    person.reader.edit_probability = 0.5;
    person.reader.decay_cells = 4.0;
    person.reader.path_removal_probability = 0.6;
    person.reader.misplacement_probability = 0.3;
    person.reader.lapse_probability = 0.3;
    person.reader.guess_probability = 0.05;
    person.reader.edit_limit = 2;
    person.planner.horizon = "next_goal";
    person.steering.reaction_steps = 2;
    person.steering.slip_probability = 0.04;
    person.steering.overshoot_probability = 0.1;
  } else if (kind == "wrong") {
    person.reader.edit_probability = 0.0;
    person.reader.path_removal_probability = 0.0;
    person.reader.far_centre_probability = 0.0;
    person.reader.lapse_probability = 0.0;
    person.reader.guess_probability = 1.0;
    person.planner.horizon = "away";
  } else {
    person.silent = kind == "silent";
    DEMAND(kind == "careful" || kind == "silent", kind);
  }
  return person;
}

}  // namespace conav::operators
