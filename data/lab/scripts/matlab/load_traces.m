function [t, omega, Iq, T] = load_traces(name)
% Time - s, speed - rad/s, current - A, and the sample period - s - of a recording.
table = dlmread(data_file(fullfile('recordings', [name '.csv'])), ',', 1, 0);
t = table(:, 1);
omega = table(:, 2);
Iq = table(:, 3);
v = course_values();
T = v.(['T_' name]).value;
end
