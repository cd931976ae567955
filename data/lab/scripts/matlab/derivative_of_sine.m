% Task 2: the backward difference of sin(t) against cos(t), t = 0 : 0.001 : 2*pi.
T = 0.001;
t = (0 : T : 2 * pi)';
derivative = num_derivative(sin(t), T);
show('largest error of the backward difference', max(abs(derivative(2:end) - cos(t(2:end)))), '1/s');
figure;
plot(t, cos(t), t, derivative, '--'); xlabel('time / s'); legend('cos(t)', 'backward difference'); grid on
keep_figure('task02');
