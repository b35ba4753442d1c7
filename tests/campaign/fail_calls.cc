// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Linked between the program and its libraries (--wrap), for calls that cannot be replaced by a library that is loaded
// before it, or not by one in C: memory for the program itself and for images of OpenCV (other libraries may abort
// where they get none), the decoders of OpenCV, and Ceres. Which one fails says fail_nth.c.
#include <cstdlib>
#include <cstring>
#include <new>

#include <ceres/gradient_problem_solver.h>
#include <ceres/solver.h>
#include <dlfcn.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>

namespace {

// Whether this call of the kind is the one that is to fail; never without fail_nth.c.
bool Fails(const char* kind) {
  static const auto fails = reinterpret_cast<int (*)(const char*)>(dlsym(RTLD_DEFAULT, "PliantFails"));
  return fails != nullptr && fails(kind) != 0;
}

constexpr std::size_t kLarge = 65536;  // bytes

bool FailsToGive(std::size_t size) { return size >= kLarge && Fails("malloc"); }

template <class Summary>
void Fail(Summary* summary) {
  *summary = {};
  summary->termination_type = ceres::FAILURE;
  summary->message = "a fault that was asked for";
}

}  // namespace

// The linker's names of the calls: __wrap_NAME takes them, __real_NAME makes them.
#define WRAPPED(name) __asm__("__wrap_" name)
#define REAL(name) __asm__("__real_" name)
#define IMDECODE "_ZN2cv8imdecodeERKNS_11_InputArrayEi"
#define GRAB "_ZN2cv12VideoCapture4grabEv"
#define SOLVE "_ZN5ceres5SolveERKNS_6Solver7OptionsEPNS_7ProblemEPNS0_7SummaryE"
#define GRADIENT_SOLVE "_ZN5ceres5SolveERKNS_21GradientProblemSolver7OptionsERKNS_15GradientProblemEPdPNS0_7SummaryE"

void* RealMalloc(std::size_t size) REAL("malloc");
void* Malloc(std::size_t size) WRAPPED("malloc");
cv::Mat RealImdecode(cv::InputArray file, int flags) REAL(IMDECODE);
cv::Mat Imdecode(cv::InputArray file, int flags) WRAPPED(IMDECODE);
bool RealGrab(cv::VideoCapture* capture) REAL(GRAB);
bool Grab(cv::VideoCapture* capture) WRAPPED(GRAB);
void RealSolve(const ceres::Solver::Options& options, ceres::Problem* problem, ceres::Solver::Summary* summary)
    REAL(SOLVE);
void Solve(const ceres::Solver::Options& options, ceres::Problem* problem, ceres::Solver::Summary* summary)
    WRAPPED(SOLVE);
void RealSolve(const ceres::GradientProblemSolver::Options& options, const ceres::GradientProblem& problem,
               double* parameters, ceres::GradientProblemSolver::Summary* summary) REAL(GRADIENT_SOLVE);
void Solve(const ceres::GradientProblemSolver::Options& options, const ceres::GradientProblem& problem,
           double* parameters, ceres::GradientProblemSolver::Summary* summary) WRAPPED(GRADIENT_SOLVE);

void* Malloc(std::size_t size) { return FailsToGive(size) ? nullptr : RealMalloc(size); }

cv::Mat Imdecode(cv::InputArray file, int flags) { return Fails("decode") ? cv::Mat() : RealImdecode(file, flags); }

bool Grab(cv::VideoCapture* capture) { return !Fails("decode") && RealGrab(capture); }

void Solve(const ceres::Solver::Options& options, ceres::Problem* problem, ceres::Solver::Summary* summary) {
  if (Fails("solve"))
    Fail(summary);
  else
    RealSolve(options, problem, summary);
}

void Solve(const ceres::GradientProblemSolver::Options& options, const ceres::GradientProblem& problem,
           double* parameters, ceres::GradientProblemSolver::Summary* summary) {
  if (Fails("solve"))
    Fail(summary);
  else
    RealSolve(options, problem, parameters, summary);
}

void* operator new(std::size_t size) {
  if (void* memory = FailsToGive(size) ? nullptr : RealMalloc(size == 0 ? 1 : size)) return memory;
  throw std::bad_alloc();
}
void* operator new(std::size_t size, std::align_val_t alignment) {
  void* memory = nullptr;
  if (!FailsToGive(size) && posix_memalign(&memory, static_cast<std::size_t>(alignment), size) == 0) return memory;
  throw std::bad_alloc();
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t /*size*/) noexcept { std::free(memory); }
void operator delete(void* memory, std::align_val_t /*alignment*/) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t /*size*/, std::align_val_t /*alignment*/) noexcept { std::free(memory); }

namespace cv {

// A BufferArea of OpenCV 4.6 that gets no memory throws in its destructor, which ends the program: it is left alone.
void* fastMalloc(std::size_t size) {
  static const auto real = reinterpret_cast<void* (*)(std::size_t)>(dlsym(RTLD_NEXT, "_ZN2cv10fastMallocEm"));
  Dl_info caller = {};
  const bool is_named = dladdr(__builtin_return_address(0), &caller) != 0 && caller.dli_sname != nullptr;
  const bool is_buffer_area = is_named && std::strstr(caller.dli_sname, "BufferArea") != nullptr;
  if (!is_buffer_area && FailsToGive(size))
    error(Error::StsNoMem, "Failed to allocate", "fastMalloc", __FILE__, __LINE__);
  return real(size);
}

}  // namespace cv
