//! How many steps are due, and how fast time passes on screen.

/// Weight of the newest share in the smoothed speed.
const SMOOTHING: f64 = 0.1;

/// Keeps the simulation's clock beside the app's. All times in seconds.
#[derive(Debug)]
pub(crate) struct Pace {
    /// Time that the app has moved on and the simulation has not.
    owed: f64,
    /// Computing time left; less than none is paid back first.
    allowance: f64,
    /// The app's time since the last steps were finished.
    since: f64,
    /// Whether time was dropped.
    is_behind: bool,
    /// Time on screen over the app's time.
    pub(crate) rate: f64,
    /// Simulated over the app's time, smoothed.
    pub(crate) speed: f64,
}

impl Default for Pace {
    fn default() -> Self {
        Self {
            owed: 0.0,
            allowance: 0.0,
            since: 0.0,
            is_behind: false,
            rate: 1.0,
            speed: 1.0,
        }
    }
}

impl Pace {
    /// The app moves on by `delta`. Unused budget is not kept, but while steps are in flight
    /// each frame pays for its part of them.
    pub(crate) fn tick(&mut self, delta: f64, budget: f64, in_flight: bool) {
        self.owed += delta;
        self.since += delta;
        self.allowance += budget;
        if !in_flight {
            self.allowance = self.allowance.min(budget);
        }
    }

    /// How many steps to do now. What more is owed is dropped.
    pub(crate) fn due(&mut self, step: f64, max_steps: u32) -> u32 {
        // A whole number of steps may be short of it by rounding.
        let owed = (self.owed / step + 1e-6).floor();
        if owed < 1.0 || self.allowance <= 0.0 {
            return 0;
        }
        self.owed = (self.owed - owed * step).max(0.0);
        self.is_behind = owed > f64::from(max_steps);
        (owed as u32).min(max_steps)
    }

    /// Steps are finished: `simulated` of the `planned` time, in `took` of real time.
    pub(crate) fn done(&mut self, simulated: f64, planned: f64, took: f64) {
        self.allowance -= took;
        self.is_behind |= simulated < 0.999 * planned;
        if self.since > 0.0 {
            let share = simulated / self.since;
            self.rate = if self.is_behind { share.min(1.0) } else { 1.0 };
            self.speed += SMOOTHING * (share - self.speed);
        }
        self.since = 0.0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEP: f64 = 0.01;
    const BUDGET: f64 = 0.012;

    #[test]
    fn all_time_is_simulated_where_the_machine_is_fast() {
        for frame in [0.004, 0.01, 0.016_667, 0.033] {
            let mut pace = Pace::default();
            let mut steps = 0;
            for _ in 0..600 {
                pace.tick(frame, BUDGET, false);
                let due = pace.due(STEP, 8);
                steps += due;
                if due > 0 {
                    let simulated = f64::from(due) * STEP;
                    pace.done(simulated, simulated, 0.001);
                }
                assert_eq!(pace.rate, 1.0);
            }
            let simulated = f64::from(steps) * STEP;
            assert!((600.0 * frame - simulated).abs() <= STEP + 1e-9);
            assert!((pace.speed - 1.0).abs() < 0.3, "{}", pace.speed);
        }
    }

    #[test]
    fn a_slow_machine_slows_the_liquid_to_what_it_can() {
        // A step takes 50 ms: in five frames of 10 ms, paid for by 5 more beyond their 60 ms
        // at full budget.
        let mut pace = Pace::default();
        let (mut simulated, mut app, mut left) = (0.0, 0.0, None);
        for _ in 0..5000 {
            let frame = 0.01;
            app += frame;
            pace.tick(frame, 0.01, left.is_some());
            left = match left {
                Some(1) => {
                    pace.done(STEP, STEP, 0.05);
                    simulated += STEP;
                    None
                }
                Some(frames) => Some(frames - 1),
                None => (pace.due(STEP, 1) > 0).then_some(5),
            };
        }
        let share = simulated / app;
        assert!((0.14..=0.2).contains(&share), "{share}");
        assert!((pace.speed / share - 1.0).abs() < 0.2);
        assert!((pace.rate / share - 1.0).abs() < 0.2);
    }

    #[test]
    fn overdrawn_budgets_are_paid_back() {
        let mut pace = Pace::default();
        let mut started = 0;
        for _ in 0..100 {
            pace.tick(STEP, BUDGET, false);
            if pace.due(STEP, 1) > 0 {
                started += 1;
                pace.done(STEP, STEP, 3.5 * BUDGET);
            }
        }
        // 3.5 budgets each in a hundred: 28.6, the last perhaps still unpaid.
        assert!((28..=29).contains(&started), "{started}");
    }

    #[test]
    fn a_hitch_is_not_caught_up() {
        let mut pace = Pace::default();
        pace.tick(10.0, BUDGET, false);
        assert_eq!(pace.due(STEP, 8), 8);
        pace.done(8.0 * STEP, 8.0 * STEP, 0.0);
        pace.tick(STEP, BUDGET, false);
        assert_eq!(pace.due(STEP, 8), 1);
    }
}
