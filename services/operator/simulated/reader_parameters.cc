#include "operator/simulated/picture_reader.h"

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

}  // namespace conav::operators
