// SPDX-License-Identifier: BSD-3-Clause
// Growth of the time of an update with the problem size.
#include <algorithm>
#include <cstddef>
#include <functional>
#include <map>

#include "bench/measure.hpp"
#include "plot/chart.hpp"

namespace rio::bench {

namespace {

/// One axis: the sizes, how a size is requested, and how the actual size is measured.
struct Axis {
  const char* title;
  const char* size;
  std::vector<int> sizes;
  std::function<void(int, Options*)> ask;
  double (*got)(const Figures& figures, const Options& options);
  bool of_detections = false;  ///< its size is a property of the load
};

struct Estimator {
  const char* preset;
  BackEnd backend;
  std::string label() const {
    return std::string(preset) + (backend == BackEnd::kEkf ? ", filter" : ", smoother");
  }
};

constexpr int kUsualDetections = 30;
constexpr int kManyDetections = 60;  ///< enough to fill all landmarks

class Sweep {
 public:
  explicit Sweep(double seconds) : seconds_(seconds) {}

  Growth along(const Axis& axis, int detections, const std::vector<Estimator>& estimators) {
    Growth growth{axis.title, axis.size, {}};
    for (const Estimator& estimator : estimators) {
      GrowthCurve curve{estimator.label(), {}};
      for (const int size : axis.sizes) {
        const io::Dataset& load = load_of(axis.of_detections ? size : detections);
        Options options = options_for(load, estimator.preset, estimator.backend);
        axis.ask(size, &options);
        if (!options.validate()) break;
        const Figures figures = measure(load, options);
        curve.points.push_back(
            {axis.got(figures, options), figures.update.median, figures.update.p99});
      }
      growth.curves.push_back(std::move(curve));
    }
    return growth;
  }

 private:
  const io::Dataset& load_of(int detections) {
    const auto known = loads_.find(detections);
    if (known != loads_.end()) return known->second;
    return loads_[detections] = make_load(static_cast<std::size_t>(detections), seconds_);
  }

  double seconds_;
  std::map<int, io::Dataset> loads_;
};

const Axis kDetections{"Detections",
                       "detections in a scan",
                       {17, 30, 60, 128, 256, 500, 1000},
                       [](int n, Options* o) { o->frontend.max_detections = n; },
                       [](const Figures& f, const Options&) { return f.detections; },
                       true};
const Axis kLandmarks{"Landmarks",
                      "landmarks in the state",
                      {5, 10, 20, 40, 64},
                      [](int n, Options* o) { o->update.max_landmarks = n; },
                      [](const Figures& f, const Options&) { return f.landmarks; }};
const Axis kClones{"Clones",
                   "past poses in the state",
                   {1, 3, 7, 10, 15, 20},
                   [](int n, Options* o) { o->update.max_clones = n; },
                   [](const Figures& f, const Options&) { return f.clones; }};
const Axis kWindow{
    "Window",
    "states in the window",
    {3, 5, 10, 15, 19, 30},
    [](int n, Options* o) { o->smoother.window = n; },
    [](const Figures&, const Options& o) { return static_cast<double>(o.smoother.window); }};

}  // namespace

std::vector<Growth> measure_growth(double seconds) {
  constexpr Estimator kFilter{"default", BackEnd::kEkf};
  constexpr Estimator kSmoother{"default", BackEnd::kSmoother};
  constexpr Estimator kPublishedFilter{"published-ekf", BackEnd::kEkf};
  constexpr Estimator kPublishedSmoother{"published-smoother", BackEnd::kSmoother};
  Sweep sweep(seconds);
  std::vector<Growth> all;
  all.push_back(sweep.along(kDetections, kUsualDetections, {kFilter, kSmoother}));
  all.push_back(sweep.along(kLandmarks, kManyDetections, {kFilter, kSmoother}));
  all.push_back(sweep.along(kClones, kUsualDetections, {kFilter, kPublishedFilter}));
  all.push_back(sweep.along(kWindow, kUsualDetections, {kSmoother, kPublishedSmoother}));
  return all;
}

std::string growth_chart(const std::vector<Growth>& growths) {
  std::vector<std::string> labels;  // one line style each, in all panels
  std::vector<plot::Panel> panels;
  for (const Growth& growth : growths) {
    plot::Panel panel;
    panel.title = growth.title;
    panel.x_label = growth.size;
    panel.y_label = "update, median [ms]";
    panel.from_zero = true;
    for (const GrowthCurve& curve : growth.curves) {
      auto at = std::find(labels.begin(), labels.end(), curve.label);
      if (at == labels.end()) at = labels.insert(labels.end(), curve.label);
      plot::Curve drawn{
          curve.label, {}, plot::curve_stroke(static_cast<std::size_t>(at - labels.begin()))};
      for (const GrowthPoint& point : curve.points) {
        drawn.points.push_back({point.size, 1e-3 * point.median});
      }
      panel.curves.push_back(std::move(drawn));
    }
    panels.push_back(std::move(panel));
  }
  return plot::draw_chart("Time of an update", panels, 2);
}

}  // namespace rio::bench
