// SPDX-License-Identifier: BSD-3-Clause
// Every model against the shared suite. A new model adds its case here.
#include "support/model_cases.hpp"

namespace rio::test {

using Cases =
    testing::Types<DopplerCase, TrailDistanceCase, LandmarkDistanceCase, LandmarkPositionCase,
                   LandmarkPointCase, LandmarkDopplerCase, RestCase>;
INSTANTIATE_TYPED_TEST_SUITE_P(AllModels, ModelSuite, Cases);

}  // namespace rio::test
