#include "experiments/support/fingerprint.h"

#include "experiments/runs/manifest.h"

#include <orthant/core/scenes/registry.h>
#include <orthant/core/support/hash.h>
#include <orthant/integrators/registry.h>
#include <orthant/integrators/simulate.h>
#include <orthant/solvers/registry.h>

#include <gnu/libc-version.h>

#include <atomic>
#include <charconv>
#include <chrono>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <thread>

namespace orthant {
namespace {

struct Late {};
// Stages of a solver get a share of what is left of its time: beyond this many times the time that a run has here, no
// bit depends on the clock, and a step that takes for ever ends.
constexpr double kMuchLonger = 20;

void add(std::uint64_t& hash, const Eigen::VectorXd& x) {
  hash = fnv1a({reinterpret_cast<const char*>(x.data()), static_cast<std::size_t>(x.size()) * sizeof(double)}, hash);
}

}  // namespace

std::string Fingerprint::row() const {
  std::ostringstream text;
  text << scene << ',' << integrator << ',' << solver << ',' << end << std::hex;
  for (const std::uint64_t h : hash) text << ',' << h;
  return text.str();
}

std::vector<Fingerprint> all_fingerprints() {
  std::vector<Fingerprint> all;
  for (const auto& scene : scenes())
    for (const auto& integrator : integrators())
      for (const auto& solver : solvers())
        if (solver.name != "ipopt")
          all.push_back({std::string(scene.name), std::string(integrator.name), std::string(solver.name), "", {}});
  return all;
}

std::vector<Fingerprint> all_spatial_fingerprints() {
  std::vector<Fingerprint> all;
  for (const auto& scene : spatial_scenes())
    for (const auto& integrator : integrators())
      if (integrator.make_spatial != nullptr)
        for (const char* solver : {"auto", "pgs", "newton-ac"})
          all.push_back({std::string(scene.name), std::string(integrator.name), solver, "", {}});
  return all;
}

namespace {

template <class Space>
void take_of(const typename ElementsOf<Space>::Scene& scene, Fingerprint& f, long steps, double seconds, int threads) {
  try {
    const SystemOf<Space> system(scene);
    const auto integrator = make_integrator(f.integrator, system);
    std::vector<std::unique_ptr<Solver>> helpers;
    for (int i = 1; i < threads; ++i) helpers.push_back(make_solver(f.solver));
    integrator->employ(std::move(helpers));
    const double step = std::min(system.scene().step, 1e-3);
    std::uint64_t hash = kHashOfNothing;
    long done = -1;  // the start is a moment, too
    const Clock clock{.step = step, .duration = static_cast<double>(steps) * step, .time_limit = kMuchLonger * seconds};
    const auto begin = std::chrono::steady_clock::now();
    const Run run = simulate(*integrator, *make_solver(f.solver), clock, [&](const RunSampleOf<Space>& moment) {
      add(hash, moment.state.q), add(hash, moment.state.v);
      ++done;
      if (std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count() > seconds) throw Late();
      for (std::size_t k = 0; k < kMarks.size(); ++k)
        if (done == kMarks[k]) f.hash[k] = hash;
    });
    f.end = name(run.status);
  } catch (
      const Late&) {  // between two steps: a solver's own time limit may end a search that it would have gone on with
    f.end = "late";
  } catch (const std::invalid_argument&) {
    f.end = "refused";
  }
}

}  // namespace

void take(Fingerprint& f, long steps, double seconds, int threads) {
  const AnyScene scene = make_any_scene(f.scene);
  if (const auto* planar = std::get_if<Scene>(&scene))
    take_of<Planar>(*planar, f, steps, seconds, threads);
  else
    take_of<Spatial>(std::get<spatial::Scene>(scene), f, steps, seconds, threads);
}

void take(std::vector<Fingerprint>& all, long steps, double seconds, int threads, const std::function<void()>& done) {
  std::atomic<std::size_t> next{0};
  std::vector<std::jthread> running;
  for (int i = 0; i < threads; ++i)
    running.emplace_back([&] {
      for (std::size_t k = next++; k < all.size(); k = next++) {
        take(all[k], steps, seconds, threads);
        if (done) done();
      }
    });
}

bool differ(const Fingerprint& a, const Fingerprint& b) {
  for (std::size_t k = 0; k < kMarks.size(); ++k)
    if (a.hash[k] != 0 && b.hash[k] != 0 && a.hash[k] != b.hash[k]) return true;
  return false;
}

namespace {

/// What libraries choose their loops by: processors of one name differ in it.
std::string instruction_sets() {
  std::string known;
  if (__builtin_cpu_supports("fma")) known += " fma";
  if (__builtin_cpu_supports("avx2")) known += " avx2";
  if (__builtin_cpu_supports("avx512f")) known += " avx512f";
  if (__builtin_cpu_supports("avx512bf16")) known += " avx512bf16";
  return known;
}

}  // namespace

std::string build_of_bits() {
  const auto about = manifest();
  return about["compiler"].get<std::string>() + "; " + about["flags"].get<std::string>() + "; glibc " +
         gnu_get_libc_version() + "; " + about["cpu"].get<std::string>() + instruction_sets();
}

std::string table_of(const std::vector<Fingerprint>& all) {
  std::string text = "# " + build_of_bits() + "\nscene,integrator,solver,end";
  for (const long mark : kMarks) text += ",after_" + std::to_string(mark);
  text += '\n';
  for (const Fingerprint& f : all) text += f.row() + '\n';
  return text;
}

std::vector<Fingerprint> read_fingerprints(const std::string& file, std::string& build) {
  std::ifstream in(file);
  std::string line;
  if (!std::getline(in, line) || !line.starts_with("# ")) throw std::runtime_error(file + ": names no build");
  build = line.substr(2);
  std::getline(in, line);
  std::vector<Fingerprint> all;
  while (std::getline(in, line)) {
    std::istringstream cells(line);
    Fingerprint f;
    for (std::string* each : {&f.scene, &f.integrator, &f.solver, &f.end}) std::getline(cells, *each, ',');
    for (std::uint64_t& hash : f.hash) {
      std::string cell;
      std::getline(cells, cell, ',');
      const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), hash, 16);
      if (error != std::errc() || end != cell.data() + cell.size())
        throw std::runtime_error(file + ": '" + line + "': '" + cell + "' is no hash");
    }
    all.push_back(f);
  }
  return all;
}

}  // namespace orthant
