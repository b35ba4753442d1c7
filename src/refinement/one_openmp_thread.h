// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// CHOLMOD asks OpenMP for four threads at every supernode, on any machine. The supernodes of a refinement are small:
// with two cores half of the time goes into waking threads.
#pragma once

// Of OpenMP, whose header comes with some compilers alone.
extern "C" {
int omp_get_max_active_levels();                 // NOLINT(readability-identifier-naming)
void omp_set_max_active_levels(int max_levels);  // NOLINT(readability-identifier-naming)
}

namespace pliant {

// As long as it lives.
class OneOpenMpThread {
 public:
  OneOpenMpThread() { omp_set_max_active_levels(0); }
  ~OneOpenMpThread() { omp_set_max_active_levels(before_); }
  OneOpenMpThread(const OneOpenMpThread&) = delete;
  OneOpenMpThread& operator=(const OneOpenMpThread&) = delete;

 private:
  int before_ = omp_get_max_active_levels();
};

}  // namespace pliant
