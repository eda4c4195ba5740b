#pragma once

namespace touchstone::fast {

/// Exit codes of both programs; the README explains them.
enum ExitCode { done = 0, answer_is_no = 1, bad_input = 2, not_converged = 3, interrupted = 130 };

}  // namespace touchstone::fast
