// Words of an impact that leaves no velocities: the same in the plane and in space.
#include <orthant/integrators/step/no_solution_message.h>

#include <doctest/doctest.h>

using namespace orthant;

namespace {

template <class Space, class Scene> std::string words_of_impact(const Scene& scene, const std::string& proof = {}) {
  const SystemOf<Space> system(scene);
  TermsOf<Space> terms;
  terms.closed.emplace_back().contact = 0;
  return why_no_impact(system, terms, proof);
}

}  // namespace

TEST_CASE(
    "an impact without velocities: friction contradicts restitution, or drives press; as words in plane and space") {
  for (const double mu : {0.0, 0.3}) {
    CAPTURE(mu);
    Scene plane;
    plane.contact(DiscWall{"", plane.body({}), {0, 0}, 0.1, kGround, {0, 0}, {0, 1}, {.mu = mu}});
    spatial::Scene space;
    const BodyId ball = space.body({});
    space.contact(spatial::SpherePlane{"", ball, {0, 0, 0}, 0.1, kGround, {0, 0, 0}, {0, 0, 1}, {.mu = mu}});
    const std::string words = words_of_impact<Planar>(plane);
    CHECK(words == words_of_impact<Spatial>(space));
    CHECK(words.starts_with("friction jams contacts ") == (mu > 0));
    CHECK(words.starts_with("jammed") == (mu == 0));
    const std::string jam = "jammed: drive \"ram\", contact \"wall\" leave no motion; since t = 0";
    CHECK((words_of_impact<Planar>(plane, jam) == jam) == (mu == 0));
    CHECK((words_of_impact<Spatial>(space, "the solver ends the step's problem") == words));
  }
}
