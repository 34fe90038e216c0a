// Parts of an observation keep to their own numbers.
#include <catch2/catch.hpp>

#include "libevo/task/compiled.h"

using namespace evo;

namespace {

// What lies in [before | part of two numbers | after] once a part has written.
std::vector<double> written(
    const std::function<void(const compiled::View&, compiled::PartWriter&)>& write) {
  std::vector<double> observation{-1.0, -1.0, -1.0, -1.0};
  const Episode episode;
  try {
    write_part({write, {}}, {"part", 1, 2}, {episode, {}, {}, {}}, observation);
  } catch (const std::logic_error&) {
    observation.push_back(99.0);  // refused
  }
  return observation;
}

}  // namespace

TEST_CASE("a part writes as many numbers as it declares, or is refused") {
  using compiled::PartWriter;
  using compiled::View;
  using Numbers = std::vector<double>;
  CHECK(written([](const View&, PartWriter& out) {
          out.add(1.0);
          out.add(2.0);
        }) == Numbers{-1.0, 1.0, 2.0, -1.0});
  CHECK(written([](const View&, PartWriter& out) {
          for (const double x : {1.0, 2.0, 3.0}) out.add(x);
        }) == Numbers{-1.0, 1.0, 2.0, -1.0, 99.0});
  CHECK(written([](const View&, PartWriter& out) { out.take(3)[2] = 3.0; }) ==
        Numbers{-1.0, -1.0, -1.0, -1.0, 99.0});
  CHECK(written([](const View&, PartWriter& out) { out.add(1.0); }) ==
        Numbers{-1.0, 1.0, -1.0, -1.0, 99.0});
}
