// experiments/studies/support/contact_steps.h — contact problems of a scene in space, as its time steps pose them.
//
//   Steps of moreau-jean whose rows are contacts with a friction disc and equations only, evenly spread over the run;
//   rows in FCLIB's order: normal, two tangents, contact by contact, then the equations of joints. With a Delassus
//   operator the problem stays one, and is a global one in a file.
#pragma once

#include <orthant/core/lcp/files/io_fclib.h>
#include <orthant/core/scenes/registry.h>
#include <orthant/core/support/options.h>
#include <orthant/integrators/registry.h>
#include <orthant/integrators/simulate.h>
#include <orthant/solvers/registry.h>

#include <algorithm>
#include <optional>

namespace orthant {

/// The same problem with its rows in FCLIB's order; nothing where it has rows of another kind.
inline std::optional<ContactProblem> contacts_first(const Lcp& p) {
  const auto n = static_cast<std::size_t>(p.size());
  std::vector<Index> order;
  std::vector<char> met(n, 0);
  ContactProblem out;
  out.dimension = 3;
  for (const Friction& f : p.friction) {
    const auto normal = static_cast<std::size_t>(f.normal);
    if (f.rows != 2 || met[normal] != 0 || p.lo[f.normal] != 0 || p.hi[f.normal] != kInf) return std::nullopt;
    out.problem.friction.push_back({3 * out.contacts, 3 * out.contacts + 1, 2, f.mu});
    ++out.contacts;
    for (const Index row : {f.normal, f.first, f.first + 1})
      order.push_back(row), met[static_cast<std::size_t>(row)] = 1;
  }
  for (Index i = 0; i < p.size(); ++i) {
    if (met[static_cast<std::size_t>(i)] != 0) continue;
    if (p.lo[i] != -kInf || p.hi[i] != kInf) return std::nullopt;
    order.push_back(i);
  }
  Lcp& q = out.problem;
  const auto pick = [&](const Vector& from, Vector& to) {
    to.resize(from.size());
    for (std::size_t i = 0; i < n; ++i) to[static_cast<Index>(i)] = from[order[i]];
  };
  pick(p.b, q.b), pick(p.lo, q.lo), pick(p.hi, q.hi);
  if (const auto* delassus = std::get_if<Delassus>(&p.A)) {
    Delassus A;
    A.inverse_mass = delassus->inverse_mass;
    if (delassus->regularization.size() > 0) pick(delassus->regularization, A.regularization);
    const RowSparse& W = delassus->W;
    A.W.rows = W.rows, A.W.cols = W.cols;
    for (const Index row : order) {
      for (int k = W.start[static_cast<std::size_t>(row)]; k < W.start[static_cast<std::size_t>(row) + 1]; ++k)
        A.W.column.push_back(W.column[static_cast<std::size_t>(k)]),
            A.W.value.push_back(W.value[static_cast<std::size_t>(k)]);
      A.W.start.push_back(static_cast<int>(A.W.value.size()));
    }
    q.A = std::move(A);
  } else {
    DenseMatrix from, A;
    to_dense(p.A, from);
    A.resize(p.size(), p.size());
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j) A(static_cast<Index>(i), static_cast<Index>(j)) = from(order[i], order[j]);
    q.A = std::move(A);
  }
  return out;
}

/// At most `most` steps of a scene in space ("kapla_tower:layers=3"); title: scene and time. Throws what make_scene
/// throws, and std::invalid_argument for a planar scene.
inline std::vector<ContactProblem> contact_steps(const std::string& scene, std::size_t most) {
  const auto colon = scene.find(':');
  std::vector<std::string> sets;
  for (std::size_t from = colon; from != std::string::npos; from = scene.find(',', from + 1))
    sets.push_back(scene.substr(from + 1, scene.find(',', from + 1) - from - 1));
  const AnyScene any = make_any_scene(scene.substr(0, colon), sets);
  if (!std::holds_alternative<spatial::Scene>(any)) throw std::invalid_argument(scene + ": must be a scene in space");
  const SystemOf<Spatial> system(std::get<spatial::Scene>(any));
  const auto integrator = make_integrator("moreau-jean", system);
  const auto solver = make_solver("auto");
  std::vector<ContactProblem> all;
  const double step = system.scene().step, duration = std::min(system.scene().duration, 300 * step);
  simulate(*integrator, *solver, {.step = step, .duration = duration}, [&](const RunSampleOf<Spatial>& moment) {
    if (moment.report.lcp_rows == 0) return;
    auto now = contacts_first(integrator->problem());
    if (!now || now->contacts == 0) return;
    now->title = scene + ", t = " + detail::text_of(moment.state.t) + " s";
    all.push_back(std::move(*now));
  });
  std::vector<ContactProblem> some;
  const std::size_t count = std::min(most, all.size());
  for (std::size_t k = 0; k < count; ++k) some.push_back(std::move(all[(2 * k + 1) * all.size() / (2 * count)]));
  return some;
}

}  // namespace orthant
