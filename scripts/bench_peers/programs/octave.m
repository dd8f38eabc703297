% SPDX-License-Identifier: MIT
% IN.csv OUT.csv: dlmread, each candidate over the whole record, dlmwrite with six decimals.
words = argv (); log = dlmread (words{1}, ',', 1, 0);
speed = abs (log(:, 2)); torque = log(:, 3) - log(1, 3); out = log(:, 3);
for low = 20:20:180
  inside = speed > low & speed <= low + 20; y = torque;
  for order = 1:2
    w = 2 * pi * order * 40 * (low + 10) / 360 / 2000; gain = 1 / (1 + tan (w / 10));
    y = filter (gain * [1, -2 * cos(w), 1], [1, -2 * gain * cos(w), 2 * gain - 1], y);
  end
  out(inside) = y(inside) + log(1, 3);
end
log(:, 3) = out;
file = fopen (words{2}, 'w'); fputs (file, "time_s,velocity_deg_s,torque_nm\n"); fclose (file);
dlmwrite (words{2}, log, '-append', 'delimiter', ',', 'precision', '%.6f');
