#include "common/service/service_main.h"
#include "operator/operator_service.h"

/// conav-operator: owns what the operator believes and wants.
int main(int argc, char** argv) {
  return conav::RunServiceMain<conav::operators::OperatorConfig, conav::operators::OperatorService>(
      "operator",
      "Owns the operator's map of each world and the guidance of each robot: answers the requests "
      "of the\n"
      "console and of the simulated operator, and keeps all of it in one SQLite file.",
      argc, argv);
}
