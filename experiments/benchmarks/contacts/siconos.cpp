// Siconos Kernel and Mechanics: rigid bodies with Bullet's collisions, Moreau-Jean time stepping, θ = 1/2.
//
//   DRIVER FILE METHOD STEP DURATION     FILE: lines of model_siconos.py; METHOD: nsgs, nsn-ac, admm
//
//   Prints lines: "seconds S steps N"; "before" and "after" of each body: place, quaternion, velocity, angular velocity
//   in its frame; "contact": bodies, points on both, normal, impulse on the first, gap.
#include "thread_clock.h"

#include <MechanicsFwd.hpp>  // before the kernel: names what its visitors visit

#include <SiconosKernel.hpp>

#include <SolverOptions.h>
#include <ContactR.hpp>
#include <KneeJointR.hpp>
#include <RigidBodyDS.hpp>
#include <SiconosBulletCollisionManager.hpp>
#include <SiconosCollisionManager.hpp>
#include <SiconosContactor.hpp>
#include <SiconosShape.hpp>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

constexpr double g = 9.81;
using Body = std::shared_ptr<RigidBodyDS>;

SP::SiconosVector vector(const std::vector<double>& values) {
  auto v = std::make_shared<SiconosVector>(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) (*v)(i) = values[i];
  return v;
}

std::vector<double> numbers(std::istream& in, std::size_t count) {
  std::vector<double> values(count);
  for (double& x : values)
    if (!(in >> x)) throw std::runtime_error("FILE: a number is missing");
  return values;
}

/// Shapes are enlarged inside Bullet, whose margins are lengths: the least edge is 1 there.
std::shared_ptr<SiconosContactorSet> contactors(const std::shared_ptr<SiconosShape>& shape, double least) {
  shape->setInsideMargin(0.05 * least), shape->setOutsideMargin(0);
  auto set = std::make_shared<SiconosContactorSet>();
  set->push_back(std::make_shared<SiconosContactor>(shape));
  return set;
}

struct World {
  std::shared_ptr<NonSmoothDynamicalSystem> system;
  std::shared_ptr<SiconosBulletCollisionManager> collisions;
  std::vector<Body> bodies;
  double least = 1;
};

World read(const std::string& path, double duration) {
  std::ifstream file(path);
  World world;
  world.system = std::make_shared<NonSmoothDynamicalSystem>(0, duration);
  std::string line;
  while (std::getline(file, line)) {
    std::istringstream in(line);
    std::string kind, shape;
    in >> kind;
    if (kind == "scene") {
      const auto values = numbers(in, 2);  // friction, least length
      world.least = values[1];
      SiconosBulletOptions options;
      options.worldScale = 1 / world.least;
      world.collisions = std::make_shared<SiconosBulletCollisionManager>(options);
      world.collisions->insertNonSmoothLaw(std::make_shared<NewtonImpactFrictionNSL>(0, 0, values[0], 3), 0, 0);
    } else if (kind == "body") {
      const auto p = numbers(in, 17);  // mass, moments; place, quaternion; velocity, angular velocity
      auto inertia = std::make_shared<SimpleMatrix>(3, 3);
      inertia->zero();
      for (unsigned i = 0; i < 3; ++i) (*inertia)(i, i) = p[1 + i];
      auto body = std::make_shared<RigidBodyDS>(vector({p.begin() + 4, p.begin() + 11}),
                                                vector({p.begin() + 11, p.end()}), p[0], inertia);
      body->setFExtPtr(vector({0, 0, -p[0] * g}));
      in >> shape;
      if (shape == "sphere")
        body->setContactors(contactors(std::make_shared<SiconosSphere>(numbers(in, 1)[0]), world.least));
      if (shape == "box")
        body->setContactors(contactors(std::make_shared<SiconosBox>(vector(numbers(in, 3))), world.least));
      world.system->insertDynamicalSystem(body);
      world.bodies.push_back(body);
    } else if (kind == "plane") {  // of the height 0 in its frame, along z
      const auto p = numbers(in, 7);
      world.collisions->insertStaticContactorSet(contactors(std::make_shared<SiconosPlane>(), world.least), vector(p));
    } else if (kind == "joint") {
      const auto p = numbers(in, 5);
      const auto at = vector({p.begin() + 2, p.end()});
      const Body b = world.bodies.at(static_cast<std::size_t>(p[1]));
      const Body a = p[0] < 0 ? nullptr : world.bodies.at(static_cast<std::size_t>(p[0]));
      const auto joint = std::make_shared<KneeJointR>(at, true, a ? a : b, a ? b : nullptr);
      const auto law = std::make_shared<EqualityConditionNSL>(joint->numberOfConstraints());
      world.system->link(std::make_shared<Interaction>(law, joint), a ? a : b, a ? b : nullptr);
    }
  }
  return world;
}

void print_state(const char* when, const World& world) {
  for (const Body& body : world.bodies) {
    std::printf("%s", when);
    for (unsigned i = 0; i < 7; ++i) std::printf(" %.17g", (*body->q())(i));
    for (unsigned i = 0; i < 6; ++i) std::printf(" %.17g", (*body->twist())(i));
    std::printf("\n");
  }
}

void print_contacts(const World& world) {
  const auto number = [&](const SP::DynamicalSystem& ds) {
    for (std::size_t k = 0; k < world.bodies.size(); ++k)
      if (world.bodies[k] == ds) return static_cast<int>(k);
    return -1;
  };
  const auto graph = world.system->topology()->indexSet(1);
  InteractionsGraph::VIterator at, end;
  for (std::tie(at, end) = graph->vertices(); at != end; ++at) {
    const auto interaction = graph->bundle(*at);
    const auto contact = std::dynamic_pointer_cast<ContactR>(interaction->relation());
    if (!contact) continue;
    const auto first = graph->properties(*at).source, second = graph->properties(*at).target;
    std::printf("contact %d %d", number(first), first == second ? -1 : number(second));
    for (const auto& point : {contact->pc1(), contact->pc2()})
      for (unsigned i = 0; i < 3; ++i) std::printf(" %.17g", (*point)(i));
    const auto directions = contact->jachqT();
    for (unsigned j = 0; j < 3; ++j) std::printf(" %.17g", (*directions)(0, j));
    for (unsigned j = 0; j < 3; ++j) {
      double push = 0;
      for (unsigned i = 0; i < 3; ++i) push += (*interaction->lambda(1))(i) * (*directions)(i, j);
      std::printf(" %.17g", push);
    }
    std::printf(" %.17g\n", (*interaction->y(0))(0));
  }
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc == 1) return std::puts("nsgs\nnsn-ac\nadmm"), 0;
  if (argc != 5) throw std::invalid_argument("DRIVER FILE METHOD STEP DURATION");
  const std::string method = argv[2];
  const double h = std::atof(argv[3]), duration = std::atof(argv[4]);
  const World world = read(argv[1], duration);
  std::shared_ptr<OneStepNSProblem> problem = std::make_shared<Equality>();
  if (world.collisions) {
    const int id = method == "nsgs"     ? SICONOS_FRICTION_3D_NSGS
                   : method == "nsn-ac" ? SICONOS_FRICTION_3D_NSN_AC
                                        : SICONOS_FRICTION_3D_ADMM;
    auto cone = std::make_shared<FrictionContact>(3, id);
    cone->numericsSolverOptions()->dparam[SICONOS_DPARAM_TOL] = 1e-8;
    cone->numericsSolverOptions()->iparam[SICONOS_IPARAM_MAX_ITER] = 1000;
    cone->setMaxSize(static_cast<int>(36 * world.bodies.size()));
    cone->setKeepLambdaAndYState(true);
    problem = cone;
  }
  auto stepping = std::make_shared<TimeStepping>(world.system, std::make_shared<TimeDiscretisation>(0, h),
                                                 std::make_shared<MoreauJeanOSI>(0.5, 0.0), problem);
  if (world.collisions) stepping->insertInteractionManager(world.collisions);
  stepping->setNewtonOptions(SICONOS_TS_NONLINEAR);
  stepping->setNewtonTolerance(1e-10);
  stepping->setNewtonMaxIteration(20);
  stepping->initialize();
  const long steps = std::lround(duration / h);
  double seconds = 0;
  for (long k = 0; k < steps; ++k) {
    if (k + 1 == steps) print_state("before", world);
    const double begin = rival::thread_time();
    stepping->advanceToEvent();
    if (k + 1 == steps) {
      seconds += rival::thread_time() - begin;
      print_contacts(world);
      print_state("after", world);
      break;
    }
    stepping->processEvents();
    seconds += rival::thread_time() - begin;
  }
  std::printf("seconds %.9g steps %ld\n", seconds, steps);
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
