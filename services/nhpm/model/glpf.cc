#include "nhpm/model/glpf.h"

#include <fmt/core.h>

#include <bit>
#include <cmath>
#include <cstdint>

#include "common/runtime/config.h"
#include "common/runtime/text.h"

namespace conav::nhpm {
namespace {

/// Little-endian on every machine.
void Append(std::string& bytes, double value) {
  const auto bits = std::bit_cast<std::uint64_t>(value);
  for (int shift = 0; shift < 64; shift += 8) bytes += static_cast<char>(bits >> shift & 0xFF);
}

std::string ChecksumOf(const GlpfParameters& p) {
  std::string bytes;
  for (const double value : {p.alpha_d, p.alpha_m, p.beta, p.rho, p.lambda}) Append(bytes, value);
  bytes += p.visible_only ? '\1' : '\0';
  return Sha256Hex(bytes);
}

}  // namespace

void GlpfParameters::Visit(ConfigReader& reader) {
  reader.Field("alpha_d", alpha_d, 0.0, 10.0);
  reader.Field("alpha_m", alpha_m, 0.0, 10.0);
  reader.Field("beta", beta, 0.0, 1000.0);
  reader.Field("rho", rho, 0.0, 0.5);
  reader.Field("lambda", lambda, 0.0, 0.5);
  reader.Field("visible_only", visible_only);
  reader.Field("tie_alphas", tie_alphas);
}

Glpf::Glpf(const GlpfParameters& parameters) : parameters_(parameters) {
  if (parameters_.tie_alphas) parameters_.alpha_m = parameters_.alpha_d;
  unstimulated_ = Response(0.0);
  identity_ = {std::string(Name(PerceptionModelKind::kGlpf)), version(), ChecksumOf(parameters_)};
}

double Glpf::Stimulus(double distance_cells) const {
  return std::exp(-parameters_.alpha_d * distance_cells);
}

double Glpf::Response(double stimulus) const {
  const GlpfParameters& p = parameters_;
  return p.rho + (1.0 - p.rho - p.lambda) / (1.0 + std::exp(-p.beta * (stimulus - p.alpha_m)));
}

std::string Glpf::version() const {
  const GlpfParameters& p = parameters_;
  return fmt::format("1 alpha_d={} alpha_m={} beta={} rho={} lambda={} visible_only={}", p.alpha_d,
                     p.alpha_m, p.beta, p.rho, p.lambda, p.visible_only);
}

Result<std::vector<PerceptionAnswer>> Glpf::Predict(std::span<const PerceptionQuery> queries) {
  std::vector<PerceptionAnswer> answers;
  answers.reserve(queries.size());
  for (const PerceptionQuery& query : queries) {
    if (const auto checked = CheckPerceptionQuery(query); !checked) {
      return tl::unexpected(checked.error());
    }
    answers.push_back(Answer(query));
  }
  return answers;
}

PerceptionAnswer Glpf::Answer(const PerceptionQuery& query) const {
  const BeliefGrid& belief = query.belief;
  const auto response_at = [&](Cell cell) {
    const double rows = cell.row - query.cell.row;
    const double columns = cell.column - query.cell.column;
    return Response(Stimulus(std::sqrt(rows * rows + columns * columns)));
  };
  const auto set_add = [&](PerceptionAnswer& answer, Cell cell, double response) {
    answer.add[cell] = static_cast<float>(response * (1.0 - static_cast<double>(belief[cell])));
  };
  const auto set_remove = [&](PerceptionAnswer& answer, Cell cell, double response) {
    answer.remove[cell] = static_cast<float>(response * static_cast<double>(belief[cell]));
  };

  PerceptionAnswer answer{Grid<float>(belief.rows(), belief.columns()),
                          Grid<float>(belief.rows(), belief.columns())};
  for (std::size_t i = 0; i < belief.size(); ++i) {
    const Cell cell = belief.CellAt(i);
    if (belief.OnBorder(cell)) continue;
    set_add(answer, cell, unstimulated_);
    set_remove(answer, cell, unstimulated_);
  }
  for (const Cell cell : query.visible.walls) {
    if (!belief.OnBorder(cell)) set_add(answer, cell, response_at(cell));
  }
  for (const Cell cell : query.visible.free) {
    if (!belief.OnBorder(cell)) set_remove(answer, cell, response_at(cell));
  }
  if (parameters_.visible_only) return answer;
  for (const Cell cell : query.path) {
    if (!belief.OnBorder(cell)) set_remove(answer, cell, response_at(cell));
  }
  return answer;
}

}  // namespace conav::nhpm
