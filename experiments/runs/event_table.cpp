#include "experiments/runs/event_table.h"

#include <orthant/core/mechanics/dynamics/system.h>
#include <orthant/core/support/options.h>

#include <nlohmann/json.hpp>

#include <algorithm>

namespace orthant {
namespace {

std::string_view kind_of(const Event& event) { return kEventNames[static_cast<std::size_t>(event.kind)]; }

std::string joined_by_commas(const auto& names) {
  std::string text;
  for (const auto& name : names) text.append(text.empty() ? "" : ",").append(name);
  return text;
}

template <class Scene> std::vector<std::string> contact_names(const Scene& scene) {
  std::vector<std::string> names;
  for (const auto& contact : scene.contacts) names.push_back(std::visit([](const auto& c) { return c.name; }, contact));
  for (const auto& collision : scene.collisions) names.push_back(collision.name);
  for (const auto& friction : scene.frictions) names.push_back(friction.name);
  return names;
}

}  // namespace

template <class Space>
void append_events(const SystemOf<Space>& system, std::span<const Event> from, std::vector<Event>& to) {
  const int listed = system.listed(), contacts = system.contacts();
  const int frictions = listed + static_cast<int>(system.scene().collisions.size());
  const auto& first = system.pairs();  // of each collision, counted from the listed contacts
  for (Event event : from) {
    if (event.contact >= contacts) {
      event.contact = frictions + event.contact - contacts;
    } else if (event.contact >= listed) {
      const auto next = std::upper_bound(first.begin(), first.end(), event.contact - listed);
      event.contact = listed + static_cast<int>(next - first.begin()) - 1;
    }
    to.push_back(event);
  }
}

std::vector<std::string> event_contacts(const Scene& scene) { return contact_names(scene); }
std::vector<std::string> event_contacts(const spatial::Scene& scene) { return contact_names(scene); }

template <class Scene> std::string events_to_csv(const Scene& scene, const std::vector<Event>& events) {
  const auto names = event_contacts(scene);
  std::string text = "t,kind,contact,impulse_n,impulse_t\n";
  for (const Event& event : events)
    text.append(detail::text_of(event.t) + ',')
        .append(kind_of(event))
        .append(',' + names[static_cast<std::size_t>(event.contact)] + ',' + detail::text_of(event.normal) + ',' +
                detail::text_of(event.tangent) + '\n');
  return text;
}

template <class Scene> nlohmann::ordered_json events_to_json(const Scene& scene, const std::vector<Event>& events) {
  const auto names = event_contacts(scene);
  auto list = nlohmann::ordered_json::array();
  for (const Event& event : events)
    list.push_back({{"t", event.t},
                    {"kind", kind_of(event)},
                    {"contact", names[static_cast<std::size_t>(event.contact)]},
                    {"impulse_n", event.normal},
                    {"impulse_t", event.tangent}});
  return list;
}

template <class Scene> void events_to_hdf5(const Scene& scene, const std::vector<Event>& events, Hdf5Image& to) {
  std::vector<double> t, normal, tangent;
  std::vector<int> kind, contact;
  for (const Event& event : events) {
    t.push_back(event.t), normal.push_back(event.normal), tangent.push_back(event.tangent);
    kind.push_back(static_cast<int>(event.kind)), contact.push_back(event.contact);
  }
  to.group("events");
  to.numbers("events/t", t);
  to.numbers("events/kind", kind);
  to.numbers("events/contact", contact);
  to.numbers("events/impulse_n", normal);
  to.numbers("events/impulse_t", tangent);
  to.text("events/kinds", joined_by_commas(kEventNames));
  to.text("events/contacts", joined_by_commas(event_contacts(scene)));
}

std::filesystem::path events_file_of(const std::filesystem::path& trajectory) {
  auto file = trajectory;
  return file.replace_extension(".events.csv");
}

template void append_events(const SystemOf<Planar>&, std::span<const Event>, std::vector<Event>&);
template void append_events(const SystemOf<Spatial>&, std::span<const Event>, std::vector<Event>&);
template std::string events_to_csv(const Scene&, const std::vector<Event>&);
template std::string events_to_csv(const spatial::Scene&, const std::vector<Event>&);
template nlohmann::ordered_json events_to_json(const Scene&, const std::vector<Event>&);
template nlohmann::ordered_json events_to_json(const spatial::Scene&, const std::vector<Event>&);
template void events_to_hdf5(const Scene&, const std::vector<Event>&, Hdf5Image&);
template void events_to_hdf5(const spatial::Scene&, const std::vector<Event>&, Hdf5Image&);

}  // namespace orthant
