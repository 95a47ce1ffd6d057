// SPDX-License-Identifier: BSD-3-Clause
// The measurements of a scan that passed the gate, each with its model, radar and noise inflation.
// ScanRows builds them; the filter uses them once, the window keeps them as they are.
//
// A new model of a radar scan is one more entry of ScanMeasurements::Lists and of RadarModels.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <functional>
#include <optional>
#include <tuple>
#include <type_traits>
#include <vector>

#include "rio/models/doppler.hpp"
#include "rio/models/landmark_distance.hpp"
#include "rio/models/landmark_point.hpp"
#include "rio/models/landmark_position.hpp"
#include "rio/models/rest.hpp"
#include "rio/models/trail_distance.hpp"
#include "rio/options.hpp"
#include "rio/state/estimate.hpp"

namespace rio {

/// A measurement of model M.
template <class M>
struct Measured {
  typename M::Measurement z;
  std::size_t radar = 0;
  std::size_t landmark = 0;  ///< of a model with a landmark
  ScanId past = kNoScan;     ///< of a model with a past pose: the scan of that pose
  double weight = 1.0;       ///< 1 / noise inflation (update/noise_inflation.hpp)
};

/// Range and direction of a landmark, and its Doppler if that is used: gated together.
template <>
struct Measured<LandmarkPointModel> {
  LandmarkPointModel::Measurement z;
  std::optional<LandmarkDopplerModel::Measurement> doppler;
  std::size_t radar = 0;
  std::size_t landmark = 0;
  double weight = 1.0;
};

/// The models of a radar scan with their options.
class RadarModels {
 public:
  explicit RadarModels(const UpdateOptions& o)
      : models_(DopplerModel(o.doppler_directions), {}, {},
                LandmarkDistanceModel(o.sigma_landmark_distance), {},
                TrailDistanceModel(o.sigma_trail_distance), {}) {}

  template <class M>
  const M& of() const {
    return std::get<M>(models_);
  }

 private:
  std::tuple<DopplerModel, LandmarkPointModel, LandmarkDopplerModel, LandmarkDistanceModel,
             LandmarkPositionModel, TrailDistanceModel, RestModel>
      models_;
};

/// A list for each model.
class ScanMeasurements {
 public:
  using Lists =
      std::tuple<std::vector<Measured<DopplerModel>>, std::vector<Measured<LandmarkPointModel>>,
                 std::vector<Measured<LandmarkDistanceModel>>,
                 std::vector<Measured<LandmarkPositionModel>>,
                 std::vector<Measured<TrailDistanceModel>>, std::vector<Measured<RestModel>>>;
  /// Lengths of the lists.
  using Sizes = std::array<std::size_t, std::tuple_size_v<Lists>>;

  /// Afterwards the measurements of one scan of each radar are added without allocation.
  void reserve(const Options& options) {
    const std::size_t detections =
        options.radars() * static_cast<std::size_t>(options.frontend.max_detections);
    const auto clones = static_cast<std::size_t>(std::max(1, options.update.max_clones));
    of<DopplerModel>().reserve(detections);
    of<LandmarkPointModel>().reserve(2 * detections);  // matches and new landmarks
    of<LandmarkDistanceModel>().reserve(detections);
    of<LandmarkPositionModel>().reserve(detections);
    of<TrailDistanceModel>().reserve(detections * clones);
    of<RestModel>().reserve(options.radars());
  }

  template <class M>
  std::vector<Measured<M>>& of() {
    return std::get<std::vector<Measured<M>>>(lists_);
  }
  template <class M>
  const std::vector<Measured<M>>& of() const {
    return std::get<std::vector<Measured<M>>>(lists_);
  }
  template <class M>
  void add(const Measured<M>& m) {
    of<M>().push_back(m);
  }

  /// Calls use(m) for every measurement.
  template <class Use>
  void for_each(const Use& use) const {
    std::apply([&use](const auto&... list) { (std::ranges::for_each(list, std::ref(use)), ...); },
               lists_);
  }

  void clear() { cut({}); }
  Sizes sizes() const {
    return std::apply([](const auto&... list) { return Sizes{list.size()...}; }, lists_);
  }
  std::size_t size() const {
    return std::apply([](const auto&... list) { return (list.size() + ...); }, lists_);
  }
  /// Removes what was added since sizes().
  void cut(const Sizes& sizes) {
    for_each_list([&sizes, i = std::size_t{0}](auto& list) mutable {
      list.erase(list.begin() + static_cast<std::ptrdiff_t>(sizes[i++]), list.end());
    });
  }
  void append(const ScanMeasurements& more) {
    more.for_each([this](const auto& m) { add(m); });
  }
  bool has_landmark(std::size_t i) const {
    bool found = false;
    for_each([i, &found]<class M>(const Measured<M>& m) {
      if constexpr (M::Blocks::template has<Landmark>()) found = found || m.landmark == i;
    });
    return found;
  }
  /// Removes the measurements of landmark i; those of the last landmark are renumbered to i.
  void forget_landmark(std::size_t i, std::size_t last) {
    for_each_list([i, last]<class M>(std::vector<Measured<M>>& list) {
      if constexpr (M::Blocks::template has<Landmark>()) {
        std::erase_if(list, [i](const Measured<M>& m) { return m.landmark == i; });
        for (Measured<M>& m : list) {
          if (m.landmark == last) m.landmark = i;
        }
      }
    });
  }

 private:
  template <class Change>
  void for_each_list(Change change) {
    std::apply([&change](auto&... list) { (change(list), ...); }, lists_);
  }

  Lists lists_;
};

}  // namespace rio
