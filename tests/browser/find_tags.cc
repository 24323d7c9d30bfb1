#include <apriltag/apriltag.h>
#include <apriltag/tag36h11.h>

#include <cstdio>
#include <opencv2/imgcodecs.hpp>

/// find_tags PICTURE: AprilTag's own detector; prints a line "ID LEFT TOP RIGHT BOTTOM" in pixels for each tag36h11.
int main(int argc, char** argv) {
  if (argc != 2) return 2;
  cv::Mat picture = cv::imread(argv[1], cv::IMREAD_GRAYSCALE);
  if (picture.empty()) return 1;
  apriltag_family_t* family = tag36h11_create();
  apriltag_detector_t* detector = apriltag_detector_create();
  apriltag_detector_add_family(detector, family);
  image_u8_t image{.width = picture.cols,
                   .height = picture.rows,
                   .stride = static_cast<int32_t>(picture.step[0]),
                   .buf = picture.data};
  zarray_t* found = apriltag_detector_detect(detector, &image);
  for (int i = 0; i < zarray_size(found); ++i) {
    apriltag_detection_t* tag = nullptr;
    zarray_get(found, i, static_cast<void*>(&tag));
    double low[2] = {1e9, 1e9};
    double high[2] = {-1e9, -1e9};
    for (const auto& corner : tag->p) {
      for (int axis = 0; axis < 2; ++axis) {
        low[axis] = corner[axis] < low[axis] ? corner[axis] : low[axis];
        high[axis] = corner[axis] > high[axis] ? corner[axis] : high[axis];
      }
    }
    std::printf("%d %.2f %.2f %.2f %.2f\n", tag->id, low[0], low[1], high[0], high[1]);
  }
  apriltag_detections_destroy(found);
  apriltag_detector_destroy(detector);
  tag36h11_destroy(family);
  return 0;
}
