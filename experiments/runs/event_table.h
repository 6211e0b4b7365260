// experiments/runs/event_table.h — events of a run as a table: time, kind, contact, impulse.
//
//   CSV   t,kind,contact,impulse_n,impulse_t       kind and contact by name; a collision's pairs have its name
//   JSON  a list of objects with these keys
//   HDF5  the group "events": t, kind, contact, impulse_n, impulse_t, where kind and contact are places in the texts
//         "kinds" and "contacts", names separated by commas
// Only integrators that locate events have them: adaptive and event-driven.
#pragma once

#include <orthant/core/lcp/files/hdf5_image.h>
#include <orthant/core/mechanics/scene/scene.h>
#include <orthant/core/mechanics/spatial/scene.h>
#include <orthant/integrators/event.h>

#include <nlohmann/json_fwd.hpp>

#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace orthant {

template <class Space> class SystemOf;

/// Appends the events, each with the place of its contact among event_contacts().
template <class Space>
void append_events(const SystemOf<Space>& system, std::span<const Event> from, std::vector<Event>& to);

/// Names of the listed contacts, then of the collisions.
std::vector<std::string> event_contacts(const Scene& scene);
std::vector<std::string> event_contacts(const spatial::Scene& scene);

/// Scene: Scene or spatial::Scene.
template <class Scene> std::string events_to_csv(const Scene& scene, const std::vector<Event>& events);
template <class Scene> nlohmann::ordered_json events_to_json(const Scene& scene, const std::vector<Event>& events);
template <class Scene> void events_to_hdf5(const Scene& scene, const std::vector<Event>& events, Hdf5Image& to);

/// Where the events of a trajectory file go that cannot hold them itself: NAME.events.csv for NAME.csv and NAME.pvd.
std::filesystem::path events_file_of(const std::filesystem::path& trajectory);

}  // namespace orthant
