#include "common/service/service_main.h"
#include "operator/operator_service.h"

/// conav-operator: keeps the maps and the guidance of the operator.
int main(int argc, char** argv) {
  return conav::RunServiceMain<conav::operators::OperatorConfig, conav::operators::OperatorService>(
      "operator",
      "Owns the operator's map of each world and the guidance of each robot: answers the requests "
      "of the\n"
      "console and of the simulated operator, and keeps all of it in one SQLite file.",
      argc, argv);
}
