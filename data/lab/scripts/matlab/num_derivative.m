function du = num_derivative(u, T)
% Backward difference du(k) = (u(k) - u(k-1))/T of samples u, a period T - s - apart; its first value is 0.
du = [0; diff(u(:))] / T;
end
