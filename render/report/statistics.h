// What a few runs of each method say about the methods.
#pragma once

#include <cstddef>
#include <vector>

namespace evo::report {

// Between the two nearest of sorted values, linearly (type 7 of Hyndman and Fan, 1996).
double quantile(const std::vector<double>& sorted, double share);

// All of the following want at least one value in each sample.
double median(std::vector<double> values);

struct Interval {
  double low = 0.0;
  double high = 0.0;
};
// The 95 % interval of the median: percentile bootstrap (Efron, 1979), 10 000 resamples drawn from
// a stream of their own, so that the same values give the same interval.
Interval median_interval(const std::vector<double>& values);

// p of Mann and Whitney's U test (1947) of two samples, two-sided: of a U at least so far from its
// mean, were there no difference. Exact without ties and up to 30 values in each; else the normal
// approximation with corrections for ties and continuity. As scipy.stats.mannwhitneyu does with the
// same method.
double rank_test(const std::vector<double>& a, const std::vector<double>& b);

// The least p that the test can give for samples of that size.
double least_p(std::size_t a, std::size_t b);

// Vargha and Delaney's A (2000): how often a value of `a` is higher than one of `b`, ties
// counting half. 0.5: no difference.
double superiority(const std::vector<double>& a, const std::vector<double>& b);

// p values of several tests, corrected for their number (Holm, 1979), in the same order.
std::vector<double> corrected(const std::vector<double>& p);

}  // namespace evo::report
