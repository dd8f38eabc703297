# SPDX-License-Identifier: MIT
"""ripplenotch diagnose of a log whose gear ratio nobody knows."""


from commands import Case


class NoGearRatio(Case):
    """What needs no ratio is examined, ripple is not, and that is said."""

    MOTION = ["--motion", "rest,duration=0.5s", "--motion", "poly6,to=120deg,duration=2s", "--motion", "rest,duration=0.5s",
              "--motion", "poly6,to=-60deg,duration=3s", "--motion", "rest,duration=0.5s"]
    FRICTION = ["--effect", "coulomb-friction,torque_nm=0.5,width_deg_s=0.2", "--effect",
                "viscous-friction,coefficient_nm_per_deg_s=0.01"]

    def test_motion_that_is_too_fast_for_a_joint_is_asked_about(self):
        rows = "".join(f"{k * 0.01:.2f},{9000.0 + (k % 7):g},{0.5 + 0.01 * (k % 5):g}\n" for k in range(1000))
        (self.folder / "motor.csv").write_text("time_s,motor_velocity_deg_s,torque_nm\n" + rows)
        done = self.run_tool("diagnose", "motor.csv", "--model", "auto")
        self.assertEqual((done.returncode, done.stdout), (3, ""))
        self.assertIn("--gear-ratio", done.stderr)
        self.assertIn("--side joint", done.stderr)
