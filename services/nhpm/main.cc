#include "common/service/service_main.h"
#include "nhpm/nhpm_service.h"

/// conav-nhpm: predicts how the operator will edit the map after a picture.
int main(int argc, char** argv) {
  return conav::RunServiceMain<conav::nhpm::NhpmConfig, conav::nhpm::NhpmService>(
      "nhpm",
      "Predicts how the operator will edit the map after a picture: answers the batched "
      "perception\nrequests of planners. Several may run at once; planners take the first reply.",
      argc, argv, [](const conav::nhpm::NhpmConfig& config) { return config.name; });
}
